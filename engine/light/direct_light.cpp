#include "engine/light/direct_light.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace simvis {

// KHR_lights_punctual, "Range Property" and "Inner and Outer Cone Angles".
DirectLight direct_light(const Light& light, const glm::dmat4& frame, const glm::dvec3& point_m) {
  const glm::dvec3 shines = glm::normalize(glm::dmat3(frame) * light.direction);
  DirectLight direct{.toward = -shines, .distance_m = std::numeric_limits<double>::infinity()};
  double share = light.intensity;
  if (light.kind != LightKind::directional) {
    const glm::dvec3 way = glm::dvec3(frame[3]) - point_m;
    direct.distance_m = glm::length(way);
    if (direct.distance_m == 0) return direct;
    direct.toward = way / direct.distance_m;
    share /= direct.distance_m * direct.distance_m;
    if (light.range_m > 0) share *= std::clamp(1 - std::pow(direct.distance_m / light.range_m, 4), 0.0, 1.0);
  }
  if (light.kind == LightKind::spot) {
    const double inner = std::cos(light.inner_cone_rad), outer = std::cos(light.outer_cone_rad);
    const double cone = (glm::dot(shines, -direct.toward) - outer) / std::max(0.001, inner - outer);
    const double inside = std::clamp(cone, 0.0, 1.0);
    share *= inside * inside;
  }
  direct.irradiance = glm::dvec3(light.color) * share;
  return direct;
}

}  // namespace simvis
