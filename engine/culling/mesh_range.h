// The data of one mesh that drawing and culling use.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "engine/culling/face_planes.h"
#include "engine/culling/normal_cone.h"
#include "engine/culling/occluders.h"
#include "engine/geometry/clusters.h"

namespace simvis {

/// The location of a mesh in the terms of vkCmdDrawIndexed, if it is on the device, and its clusters.
struct MeshRange {
  std::uint32_t first_index = 0, index_count = 0;
  std::int32_t vertex_offset = 0;
  std::span<const Cluster> clusters{};  ///< first_index counts from the mesh's first index
  const Clustering* clustering = nullptr;
  bool resident = false;                   ///< false: views copy the vertices that they draw
  std::span<const NormalCone> facing{};    ///< by cluster, for shaded triangles; else empty
  std::span<const glm::vec3> positions{};  ///< in host memory
  std::span<const Occluder> occluders{};   ///< for triangles
  const FacePlanes* flat = nullptr;
  glm::vec3 bounds_min{0}, bounds_max{0};  ///< of the whole mesh, in its frame
};

}  // namespace simvis
