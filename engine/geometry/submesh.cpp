#include "engine/geometry/submesh.h"

#include <unordered_map>

namespace simvis {

std::shared_ptr<const Mesh> submesh(const Mesh& mesh, std::span<const glm::vec3> positions,
                                    std::span<const std::uint32_t> indices) {
  auto part = std::make_shared<Mesh>();
  part->name = mesh.name;
  std::unordered_map<std::uint32_t, std::uint32_t> place;  // by vertex of the mesh: parts may be small
  for (const std::uint32_t vertex : indices) {
    const auto [found, added] = place.try_emplace(vertex, static_cast<std::uint32_t>(place.size()));
    if (added) {
      part->positions.push_back(positions[vertex]);
      part->attributes.push_back(mesh.attributes[vertex]);
    }
    part->indices.push_back(found->second);
  }
  compute_bounds(*part);
  return part;
}

}  // namespace simvis
