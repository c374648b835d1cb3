// The large flat faces of a mesh, behind which other things can hide.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include <simvis/mesh.h>
#include "engine/geometry/clusters.h"

namespace simvis {

/// A triangle, or two with a side in common that make a convex quadrangle: corners 0, 1, 2 and 0, 2, 3. In the mesh's
/// frame; from the front they run counterclockwise.
struct Occluder {
  std::array<glm::vec3, 4> corners{};
  int count = 3;
};

/// So many of a mesh's triangles may be walls, or parts of walls, the largest first; none that is smaller than this
/// share of the square of the diagonal of the mesh's box.
inline constexpr std::size_t kMaxOccluders = 128;
inline constexpr double kMinOccluderShare = 1.0 / 4096;

std::vector<Occluder> extract_occluders(const Mesh& mesh, const Clustering& clustering);

}  // namespace simvis
