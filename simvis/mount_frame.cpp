#include "simvis/mount_frame.h"

#include <algorithm>
#include <cmath>

namespace simvis {

namespace {

// Below this sine between x and z, what is left of z when x is taken out is mostly rounding.
constexpr double kMinSine = 1e-6;

/// Unit length, also where the square of the length would leave the range of a double.
bool normalise(glm::dvec3& v) {
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (!(largest > 0) || !std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) return false;
  v = glm::normalize(v / largest);
  return true;
}

}  // namespace

bool rigid_mount_frame(const glm::dmat4& world_from_mount, glm::dmat4& world_from_sensor) {
  glm::dvec3 x(world_from_mount[0]), z(world_from_mount[2]);
  const glm::dvec3 position(world_from_mount[3]);
  if (!normalise(x) || !normalise(z)) return false;
  z -= glm::dot(x, z) * x;
  if (glm::length(z) < kMinSine) return false;
  z = glm::normalize(z);
  if (!std::isfinite(position.x) || !std::isfinite(position.y) || !std::isfinite(position.z)) return false;
  world_from_sensor =
      glm::dmat4(glm::dvec4(x, 0), glm::dvec4(glm::cross(z, x), 0), glm::dvec4(z, 0), glm::dvec4(position, 1));
  return true;
}

}  // namespace simvis
