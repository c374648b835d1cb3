// How exact the ranges of a scan have to be, and what a reading and its bound are.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include <simvis/location.h>
#include "sensors/raster_depth/depth_range.h"

namespace simvis {

/// Where a scanner's range ends, in metres along the ray.
struct RangeLimits {
  double min_m = 0, max_m = 0;
};

/// What a scan holds of a beam: 0 nearer than the limits, +infinity beyond them; the bound is rounded up.
struct Reading {
  float range_m = 0, error_bound_m = 0;
};

/// Applies the limits and rounds. Where the bound reaches across a limit, the reading may be of the other kind, and the
/// bound says how far that would be: infinitely, beyond the farther one.
Reading read_range(const RangeEstimate& range, const RangeLimits& limits);

/// The share of the range that `hybrid` and `auto` keep where a scene gives no tolerance.
inline constexpr double kDefaultMaxErrorRel = 1e-6;

/// Both hold where both are given.
struct ScanTolerance {
  std::optional<double> max_error_m{};         ///< along the ray
  double max_error_rel = kDefaultMaxErrorRel;  ///< as a share of the range; infinity: none
  Location where_m{}, where_rel{};             ///< who asks for it, for messages

  bool met(const Reading& reading) const {
    const double bound = reading.error_bound_m;
    if (bound == 0) return true;
    return bound <= max_error_rel * reading.range_m && std::isfinite(bound) && (!max_error_m || bound <= *max_error_m);
  }
};

/// "0.001 m", "1e-06 of the range" or "0.001 m or 1e-06 of the range".
std::string to_string(const ScanTolerance& tolerance);

/// Holds what was cast against a tolerance.
///
/// Which side of a limit a surface lies on that is within a cast range's rounding of it, some 1e-15 of the range, is
/// for rounding to decide and no breach: the bound of such a beam is taken without the limits. Nor is it one where the
/// sensor touches a surface, so that its range is no larger than its rounding.
class ToleranceCheck {
 public:
  explicit ToleranceCheck(const ScanTolerance& tolerance) : tolerance_(tolerance) {}

  void add(const RangeEstimate& cast, const Reading& reading) {
    if (!tolerance_.met(reading)) add_unmet(cast);
  }

  /// All that another has seen, too.
  void add(const ToleranceCheck& other) {
    met_ = met_ && other.met_;
    worst_m_ = std::max(worst_m_, other.worst_m_);
    worst_rel_ = std::max(worst_rel_, other.worst_rel_);
  }

  /// Throws InputError at the attribute if the tolerance was not met: it names the sensor and the best reachable.
  void require(const std::string& sensor) const;

 private:
  void add_unmet(const RangeEstimate& cast);

  const ScanTolerance& tolerance_;
  double worst_m_ = 0, worst_rel_ = 0;  // of all beams that do not meet it
  bool met_ = true;
};

}  // namespace simvis
