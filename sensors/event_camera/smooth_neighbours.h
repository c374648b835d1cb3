// Which triangles of a mesh go on smoothly in others: across their common edge the light of the surface does not jump.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <simvis/mesh.h>

namespace simvis {

inline constexpr std::uint32_t kNoNeighbour = ~std::uint32_t{0};

/// For each triangle and each of its edges, from corner k to corner k + 1: the triangle with which it shares both
/// vertices, and no third one does, if the vertices have normals or both lie in one plane. Else kNoNeighbour.
std::vector<std::array<std::uint32_t, 3>> smooth_neighbours(const Mesh& mesh);

}  // namespace simvis
