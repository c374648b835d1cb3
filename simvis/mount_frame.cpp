#include "simvis/mount_frame.h"

#include <algorithm>
#include <cmath>

namespace simvis {

namespace {

// Below this sine of the angle between x and z, the component of z orthogonal to x is mostly rounding error.
constexpr double kMinSine = 1e-6;

/// Normalises v, even if the square of its length is outside the range of a double. Returns false if v is 0 or not
/// finite.
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
