// The rotation that gives a shape along z another direction.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

namespace simvis {

/// Turns +z into `direction`, which has a length, by the shortest way; about x if it points down.
inline glm::dmat3 turn_z_to(const glm::dvec3& direction) {
  const double largest = std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
  const glm::dvec3 z = glm::normalize(direction / largest);
  constexpr double kOpposite = 1e-12;
  if (z.z < -1 + kOpposite) return {1, 0, 0, 0, -1, 0, 0, 0, -1};
  const double k = 1 / (1 + z.z);
  const glm::dvec3 x(1 - z.x * z.x * k, -z.x * z.y * k, -z.x);
  return {x, glm::cross(z, x), z};
}

}  // namespace simvis
