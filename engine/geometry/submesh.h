// Meshes made of some triangles of another mesh.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>

#include <simvis/mesh.h>

namespace simvis {

/// The triangles with these indices of the mesh's vertices. It has the vertices that they use, in the order of their
/// use, at `positions`, which has an entry for each vertex of the mesh.
std::shared_ptr<const Mesh> submesh(const Mesh& mesh, std::span<const glm::vec3> positions,
                                    std::span<const std::uint32_t> indices);

}  // namespace simvis
