#include "elements/lamp.h"

#include <cmath>

#include "engine/base/even_points.h"

namespace simvis {

glm::dvec3 place_of_point(const Lamp& lamp, std::uint32_t i) {
  return lamp.points == 1 ? glm::dvec3(0) : lamp.radius * even_point_of_ball(i, lamp.points);
}

glm::dvec3 direction_of_point(const Lamp& lamp, const glm::dvec3& direction, std::uint32_t i) {
  if (lamp.points == 1) return direction;
  const glm::dvec3 other = std::abs(direction.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  const glm::dvec3 right = glm::normalize(glm::cross(other, direction)), up = glm::cross(direction, right);
  const glm::dvec2 at = std::tan(lamp.radius) * even_point_of_disc(i, lamp.points);
  return glm::normalize(direction + at.x * right + at.y * up);
}

}  // namespace simvis
