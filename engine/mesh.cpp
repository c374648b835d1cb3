#include "engine/mesh.h"

namespace simvis {

void compute_bounds(Mesh& mesh) {
  mesh.bounds_min = mesh.bounds_max = glm::vec3(0);
  if (mesh.indices.empty()) return;
  mesh.bounds_min = mesh.bounds_max = mesh.positions[mesh.indices.front()];
  for (const std::uint32_t index : mesh.indices) {
    mesh.bounds_min = glm::min(mesh.bounds_min, mesh.positions[index]);
    mesh.bounds_max = glm::max(mesh.bounds_max, mesh.positions[index]);
  }
}

}  // namespace simvis
