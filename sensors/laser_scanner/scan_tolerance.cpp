#include "sensors/laser_scanner/scan_tolerance.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "engine/base/decimal.h"

namespace simvis {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// The next larger float32, as std::nextafter() gives it, of a value that is not negative.
float next_above(float value) {
  return value == kInfinity ? value : std::bit_cast<float>(std::bit_cast<std::uint32_t>(value) + 1);
}

// Rounded up, so that the value in a message is a tolerance that can be met.
std::string rounded_up(double value) {
  if (!std::isfinite(value)) return "inf";
  const double unit = std::pow(10, std::floor(std::log10(value)) - 2);
  return decimal(std::ceil(value / unit) * unit, 6);
}

}  // namespace

BeamReading read_range(const RangeEstimate& range, const RangeLimits& limits) {
  const double low = range.range_m - range.error_bound_m, high = range.range_m + range.error_bound_m;
  float reading = range.range_m < limits.min_m ? 0 : static_cast<float>(range.range_m);
  double bound = range.error_bound_m + std::abs(static_cast<double>(reading) - range.range_m);
  if (range.range_m > limits.max_m) {
    reading = kInfinity;
    bound = low > limits.max_m || range.error_bound_m == 0 ? 0 : kInfinity;
  } else if (high > limits.max_m) {
    bound = kInfinity;
  } else if (range.range_m < limits.min_m) {
    bound = high < limits.min_m ? 0 : high;
  } else if (low < limits.min_m) {
    bound = std::max(bound, static_cast<double>(reading));
  }
  return {reading, bound == 0 ? 0.0f : next_above(static_cast<float>(bound))};
}

std::string to_string(const ScanTolerance& tolerance) {
  std::string text;
  if (tolerance.max_error_m) text += decimal(*tolerance.max_error_m, 6) + " m";
  if (std::isfinite(tolerance.max_error_rel)) {
    text += (tolerance.max_error_m ? " or " : "") + decimal(tolerance.max_error_rel, 6) + " of the range";
  }
  return text;
}

void ToleranceCheck::add_unmet(const RangeEstimate& cast) {
  const BeamReading unlimited = read_range(cast, {0, std::numeric_limits<double>::infinity()});
  if (tolerance_.met(unlimited) || cast.range_m <= cast.error_bound_m) return;
  met_ = false;
  const double bound = unlimited.error_bound_m;
  worst_m_ = std::max(worst_m_, bound);
  worst_rel_ = std::max(worst_rel_, bound / static_cast<double>(unlimited.range_m));
}

void ToleranceCheck::require(const std::string& sensor) const {
  if (met_) return;
  const bool absolute = tolerance_.max_error_m && worst_m_ > *tolerance_.max_error_m;
  const std::string limit = decimal(absolute ? *tolerance_.max_error_m : tolerance_.max_error_rel, 6);
  fail_at(absolute ? tolerance_.where_m : tolerance_.where_rel,
          "attribute \"" + std::string(absolute ? "max_error_m" : "max_error_rel") + "\": " + limit +
              " cannot be kept by any method for sensor " + in_quotes(sensor) +
              " in this frame; the best that can be reached, with every beam cast, is " +
              rounded_up(absolute ? worst_m_ : worst_rel_) + (absolute ? " m" : " of the range"));
}

}  // namespace simvis
