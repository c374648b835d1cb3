#include "engine/bvh_mesh.h"

#include <utility>

namespace simvis {

BvhMesh::BvhMesh(std::shared_ptr<const Mesh> mesh) : RayMesh(std::move(mesh)) {
  if (radius() == 0) return;
  constexpr std::uint32_t kMostInLeaf = 4;
  std::vector<Box> boxes;
  boxes.reserve(triangles());
  for (std::uint32_t t = 0; t < triangles(); ++t) {
    const auto [a, b, c] = unit_corners(t);
    boxes.push_back({glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))});
  }
  bvh_ = build_bvh(boxes, kMostInLeaf);
}

std::array<glm::vec3, 3> BvhMesh::unit_corners(std::uint32_t primitive) const {
  std::array<glm::vec3, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 p(mesh()->positions[mesh()->indices[std::size_t{3} * primitive + k]]);
    corners[k] = (p - centre()) / radius();
  }
  return corners;
}

}  // namespace simvis
