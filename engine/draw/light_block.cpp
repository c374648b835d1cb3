#include "engine/draw/light_block.h"

#include <algorithm>
#include <cmath>

namespace simvis {
namespace {

// The smallest difference of the cones' cosines, from KHR_lights_punctual.
constexpr double kMinConeWidth = 0.001;

}  // namespace

shader::LightBlock make_light_block(const Light& light, const glm::dmat4& view_from_light) {
  shader::LightBlock block{};
  block.position = glm::vec4(glm::dvec4(glm::dvec3(view_from_light[3]), light.range_m > 0 ? 1 / light.range_m : 0.0));
  const glm::dvec3 direction = glm::dmat3(view_from_light) * light.direction;
  const double length = glm::length(direction);
  // A light that is scaled to zero has no direction and lights nothing.
  const glm::dvec3 unit = length > 0 ? direction / length : glm::dvec3(0);
  block.direction = glm::vec4(glm::dvec4(unit, 0));
  block.intensity = glm::vec4(glm::dvec4(glm::dvec3(light.color) * light.intensity, 0));
  if (light.kind == LightKind::spot) {
    const double outer = std::cos(light.outer_cone_rad);
    const double scale = 1 / std::max(kMinConeWidth, std::cos(light.inner_cone_rad) - outer);
    block.direction.w = static_cast<float>(scale);
    block.intensity.w = static_cast<float>(-outer * scale);
  }
  return block;
}

}  // namespace simvis
