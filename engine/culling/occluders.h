// The large flat faces of a mesh, which can occlude other objects.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include <simvis/mesh.h>
#include "engine/geometry/clusters.h"

namespace simvis {

/// A triangle, or two triangles with a common side that form a convex quadrangle: corners 0, 1, 2 and 0, 2, 3. The
/// corners are in the mesh's frame and run counterclockwise when seen from the front.
struct Occluder {
  std::array<glm::vec3, 4> corners{};
  int count = 3;
};

/// The largest triangles of a mesh, at most kMaxOccluders, become occluders or parts of occluders. The area of each is
/// at least kMinOccluderShare of the squared diagonal of the mesh's box.
inline constexpr std::size_t kMaxOccluders = 128;
inline constexpr double kMinOccluderShare = 1.0 / 4096;

std::vector<Occluder> extract_occluders(const Mesh& mesh, const Clustering& clustering);

}  // namespace simvis
