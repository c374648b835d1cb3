// Meshes cut into clusters, so that a view draws only those parts of a mesh that it can see.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "engine/mesh.h"

namespace simvis {

/// A run of triangles and the box that they fill, in the mesh's frame.
struct Cluster {
  std::uint32_t first_index = 0, index_count = 0;
  glm::vec3 center{0}, half_size{0};  ///< rounded outwards
};

/// The most triangles in a cluster. Smaller ones fit a view more closely and cost more looks and draws.
inline constexpr std::size_t kClusterTriangles = 32;

/// A mesh's triangles in an order in which neighbours in space are neighbours in the list.
struct ClusteredIndices {
  std::vector<std::uint32_t> indices;  ///< the same triangles, each with its corners in their order
  std::vector<Cluster> clusters;       ///< in the order of `indices`, which they cover without gaps
};

/// Halves the triangles along the longest side of their centres' box until no half has more than kClusterTriangles.
/// Lines and points are one cluster, in their order.
ClusteredIndices make_clusters(const Mesh& mesh);

/// The two steps of it for triangles: the numbers of a mesh's triangles in their new order, which depends on nothing
/// but the mesh; and the clusters of triangles that are in such an order.
std::vector<std::uint32_t> order_in_space(const Mesh& mesh);
ClusteredIndices clusters_in_order(const Mesh& mesh, std::span<const std::uint32_t> order);

}  // namespace simvis
