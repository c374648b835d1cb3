// The tolerance of a scan, readings with their bounds, and the check of cast readings against the tolerance.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include <simvis/location.h>
#include "sensors/raster_depth/depth_range.h"

namespace simvis {

/// The limits of a scanner's range, in metres along the ray.
struct RangeLimits {
  double min_m = 0, max_m = 0;
};

/// The reading of one beam: 0 nearer than the limits, +infinity beyond them; the bound is rounded up.
struct BeamReading {
  float range_m = 0, error_bound_m = 0;
};

/// Applies the limits and rounds. If the bound reaches across a limit, the true reading may lie on the other side of
/// it. The bound then covers that reading, too; it is infinite for the farther limit.
BeamReading read_range(const RangeEstimate& range, const RangeLimits& limits);

/// The default tolerance of `hybrid` and `auto`, as a share of the range.
inline constexpr double kDefaultMaxErrorRel = 1e-6;

/// The largest bounds that are allowed; a reading must meet both if both are given.
struct ScanTolerance {
  std::optional<double> max_error_m{};         ///< along the ray
  double max_error_rel = kDefaultMaxErrorRel;  ///< as a share of the range; infinity: no limit
  Location where_m{}, where_rel{};             ///< where the tolerance is set, for messages

  bool met(const BeamReading& reading) const {
    const double bound = reading.error_bound_m;
    if (bound == 0) return true;
    return bound <= max_error_rel * reading.range_m && std::isfinite(bound) && (!max_error_m || bound <= *max_error_m);
  }
};

/// "0.001 m", "1e-06 of the range" or "0.001 m or 1e-06 of the range".
std::string to_string(const ScanTolerance& tolerance);

/// Checks cast readings against a tolerance.
///
/// If a surface lies within the rounding of a cast range from a limit, some 1e-15 of the range, rounding decides on
/// which side of the limit it lies. This is no violation: the bound of such a beam is taken without the limits. It is
/// also no violation if the sensor touches a surface, so that its range is not larger than its rounding.
class ToleranceCheck {
 public:
  explicit ToleranceCheck(const ScanTolerance& tolerance) : tolerance_(tolerance) {}

  void add(const RangeEstimate& cast, const BeamReading& reading) {
    if (!tolerance_.met(reading)) add_unmet(cast);
  }

  /// Adds all readings of another check.
  void add(const ToleranceCheck& other) {
    met_ = met_ && other.met_;
    worst_m_ = std::max(worst_m_, other.worst_m_);
    worst_rel_ = std::max(worst_rel_, other.worst_rel_);
  }

  /// Throws InputError at the attribute if the tolerance was not met. The message names the sensor and the smallest
  /// tolerance that can be met.
  void require(const std::string& sensor) const;

 private:
  void add_unmet(const RangeEstimate& cast);

  const ScanTolerance& tolerance_;
  double worst_m_ = 0, worst_rel_ = 0;  // over all beams that do not meet the tolerance
  bool met_ = true;
};

}  // namespace simvis
