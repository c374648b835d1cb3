#include "engine/base/sine_of_degrees.h"

#include <cmath>
#include <numbers>

namespace simvis {

SineCosine sine_of_degrees(double angle_deg) {
  // Both remainders are exact in floating point. `rest` lies within +-45 degrees.
  const double turn_part = std::remainder(angle_deg, 360.0);
  const double rest = std::remainder(turn_part, 90.0);
  const int quarter = static_cast<int>(std::lround((turn_part - rest) / 90.0)) & 3;
  const double radians = rest * (std::numbers::pi / 180.0);
  // The addition of 0 turns -0 into 0, so that equal angles give equal bytes.
  const double s = std::sin(radians) + 0.0, c = std::cos(radians);
  switch (quarter) {
    case 0:
      return {s, c};
    case 1:
      return {c, 0.0 - s};
    case 2:
      return {0.0 - s, -c};
    default:
      return {-c, s};
  }
}

}  // namespace simvis
