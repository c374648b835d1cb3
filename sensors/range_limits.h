// The smallest and the largest range that a sensor of one range reports, and its attributes for them.
#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include <simvis/error.h>
#include "scenegraph/language/attribute_rows.h"

namespace simvis {

struct MeasuredLimits {
  double min_m = 0, max_m = 0;
};

// sensor_msgs/Range: kinds of radiation.
inline constexpr double kUltrasoundRange = 0, kInfraredRange = 1;

/// `along` stands behind "this" in the texts: " along the axis". Throws InputError if range_max is below range_min.
inline AttributeRows<MeasuredLimits> range_limit_rows(std::string_view along = {}) {
  const auto text = [&](const char* side, const char* reads) {
    return keep_text("a surface " + std::string(side) + " than this" + std::string(along) + " reads " + reads +
                     " in range_m");
  };
  return {row(&MeasuredLimits::min_m, "range_min", "m", kNotNegative, text("nearer", "0")),
          row(&MeasuredLimits::max_m, "range_max", "m", kAboveZero, text("farther", "inf")),
          checked<MeasuredLimits>([](const MeasuredLimits& limits, const AttributeValues& attributes) {
            if (limits.min_m <= limits.max_m) return;
            fail_at(attributes.where("range_max"), "attribute \"range_max\": " + format_number(limits.max_m) +
                                                       " is not allowed with range_min=\"" +
                                                       format_number(limits.min_m) + "\", expected that or more");
          })};
}

/// The range as it is reported: 0 below the limits, +infinity beyond them.
inline double limited_range(const MeasuredLimits& limits, double range_m) {
  if (range_m < limits.min_m) return 0;
  return range_m > limits.max_m ? std::numeric_limits<double>::infinity() : range_m;
}

inline bool is_between_limits(double reported_m) { return reported_m > 0 && std::isfinite(reported_m); }

}  // namespace simvis
