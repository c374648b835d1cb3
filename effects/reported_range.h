// The range that a scanner, a range sensor, a sonar, a radar or a beacon reports after errors have changed it.
#pragma once

namespace simvis {

/// The range in metres, at least 0. As of a range without errors, 0 means that the surface is nearer than range_min.
/// The limits are those of the true range: errors alone make no range +infinity, and none below range_min 0.
inline double reported_range_m(double range_m) { return range_m > 0 ? range_m : 0; }

}  // namespace simvis
