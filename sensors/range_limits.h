// The smallest and the largest range that a sensor of one range reports, and its attributes for them.
#pragma once

#include <cmath>
#include <limits>
#include <string_view>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/error.h>

namespace simvis {

struct MeasuredLimits {
  double min_m = 0, max_m = 0;
};

// sensor_msgs/Range: kinds of radiation.
inline constexpr double kUltrasoundRange = 0, kInfraredRange = 1;

inline std::vector<AttributeSpec> range_limit_rows(std::string_view min_m, std::string_view max_m) {
  return {{.name = "range_min",
           .default_value = min_m,
           .unit = "m",
           .text = "a surface nearer than this reads 0 in range_m",
           .min = 0},
          {.name = "range_max",
           .default_value = max_m,
           .unit = "m",
           .text = "a surface farther than this reads inf in range_m",
           .min = 0,
           .open_min = true}};
}

/// Throws InputError if range_max is below range_min.
inline MeasuredLimits read_range_limits(const AttributeValues& attributes) {
  const MeasuredLimits limits{attributes.number("range_min"), attributes.number("range_max")};
  if (limits.min_m > limits.max_m) {
    fail_at(attributes.where("range_max"), "attribute \"range_max\": " + format_number(limits.max_m) +
                                               " is not allowed with range_min=\"" + format_number(limits.min_m) +
                                               "\", expected that or more");
  }
  return limits;
}

/// The range as it is reported: 0 below the limits, +infinity beyond them.
inline double limited_range(const MeasuredLimits& limits, double range_m) {
  if (range_m < limits.min_m) return 0;
  return range_m > limits.max_m ? std::numeric_limits<double>::infinity() : range_m;
}

inline bool is_between_limits(double reported_m) { return reported_m > 0 && std::isfinite(reported_m); }

}  // namespace simvis
