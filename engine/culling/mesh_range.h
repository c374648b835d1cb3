// What drawing and culling need to know of one mesh.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "engine/culling/face_planes.h"
#include "engine/culling/normal_cone.h"
#include "engine/culling/occluders.h"
#include "engine/geometry/clusters.h"

namespace simvis {

/// Where a mesh lies, in the terms of vkCmdDrawIndexed, if it is on the device; and its clusters.
struct MeshRange {
  std::uint32_t first_index = 0, index_count = 0;
  std::int32_t vertex_offset = 0;
  std::span<const Cluster> clusters{};  ///< their index numbers count from the mesh's first
  const Clustering* clustering = nullptr;
  std::span<const NormalCone> facing{};    ///< of each cluster, of triangles that are shaded; else empty
  std::span<const glm::vec3> positions{};  ///< in host memory
  std::span<const Occluder> occluders{};   ///< of triangles
  const FacePlanes* flat = nullptr;
};

}  // namespace simvis
