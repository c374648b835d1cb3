#include "engine/draw/oriented_box.h"

#include <limits>

namespace simvis {

OrientedBox oriented_box(const Mesh& mesh, const glm::dmat4& frame_from_mesh) {
  const glm::dmat3 linear(frame_from_mesh);
  glm::dmat3 axes(1);
  axes[0] = glm::normalize(linear[0]);
  axes[1] = glm::normalize(linear[1] - glm::dot(linear[1], axes[0]) * axes[0]);
  axes[2] = glm::cross(axes[0], axes[1]);
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 at((corner & 1) != 0 ? mesh.bounds_max.x : mesh.bounds_min.x,
                        (corner & 2) != 0 ? mesh.bounds_max.y : mesh.bounds_min.y,
                        (corner & 4) != 0 ? mesh.bounds_max.z : mesh.bounds_min.z);
    const glm::dvec3 turned = glm::transpose(axes) * (linear * at);
    low = glm::min(low, turned);
    high = glm::max(high, turned);
  }
  OrientedBox box{.centre_m = axes * ((low + high) / 2.0) + glm::dvec3(frame_from_mesh[3]),
                  .size_m = high - low,
                  .orientation = glm::normalize(glm::quat_cast(axes))};
  if (box.orientation.w < 0) box.orientation = -box.orientation;
  return box;
}

}  // namespace simvis
