#include "sensors/thermal_camera/false_color.h"

#include <cmath>
#include <numbers>

namespace simvis {

glm::dvec3 false_color(double share) {
  constexpr double kStart = 0.5, kTurns = -1.5, kHue = 1;
  // Red, green and blue by the cosine and by the sine of the angle, from the article.
  constexpr double kCosine[] = {-0.14861, -0.29227, 1.97294}, kSine[] = {1.78277, -0.90649, 0};
  const double angle = 2 * std::numbers::pi * (kStart / 3 + 1 + kTurns * share);
  const double amplitude = kHue * share * (1 - share) / 2, c = std::cos(angle), s = std::sin(angle);
  glm::dvec3 code;
  for (int i = 0; i < 3; ++i) code[i] = share + amplitude * (kCosine[i] * c + kSine[i] * s);
  return glm::clamp(code, 0.0, 1.0);
}

}  // namespace simvis
