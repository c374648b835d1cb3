#include <simvis/mesh.h>

#include <algorithm>
#include <cmath>

namespace simvis {

void compute_bounds(Mesh& mesh) {
  mesh.bounds_min = mesh.bounds_max = glm::vec3(0);
  mesh.longest_edge = 0;
  if (mesh.indices.empty()) return;
  mesh.bounds_min = mesh.bounds_max = mesh.positions[mesh.indices.front()];
  for (const std::uint32_t index : mesh.indices) {
    mesh.bounds_min = glm::min(mesh.bounds_min, mesh.positions[index]);
    mesh.bounds_max = glm::max(mesh.bounds_max, mesh.positions[index]);
  }
  if (mesh.topology != Topology::triangles) return;
  double square = 0;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const glm::dvec3 a(mesh.positions[mesh.indices[i]]), b(mesh.positions[mesh.indices[i + 1]]),
        c(mesh.positions[mesh.indices[i + 2]]);
    square = std::max({square, glm::dot(b - a, b - a), glm::dot(c - b, c - b), glm::dot(a - c, a - c)});
  }
  mesh.longest_edge = std::sqrt(square);
}

}  // namespace simvis
