// Meshes cut into clusters, so that a view draws only those parts of a mesh that it can see.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include <simvis/mesh.h>

namespace simvis {

class ThreadPool;

/// A run of triangles and the box that they fill, in the mesh's frame.
struct Cluster {
  std::uint32_t first_index = 0, index_count = 0;
  std::uint32_t first_vertex = 0, vertex_count = 0;  ///< in Clustering::vertices
  glm::vec3 center{0}, half_size{0};                 ///< rounded outwards
};

/// The most triangles in a cluster. Smaller ones fit a view more closely and cost more looks and draws.
inline constexpr std::size_t kClusterTriangles = 32;

/// A mesh's triangles in an order in which neighbours in space are neighbours in the list, which the clusters cover
/// without gaps; each triangle with its corners in their order. Of lines and points there is one cluster, in the mesh's
/// own order, and neither vertices nor corners.
///
/// Triangles of a cluster share most of their vertices, so each is named once, and corners say which: half of what a
/// list of indices takes, and a vertex need not be looked at for each of its triangles.
struct Clustering {
  std::vector<Cluster> clusters;
  std::vector<std::uint32_t> vertices;  ///< of the mesh, that of one cluster after the other
  std::vector<std::uint8_t> corners;    ///< one for each index: which of its cluster's vertices

  std::span<const std::uint32_t> vertices_of(const Cluster& cluster) const {
    return std::span(vertices).subspan(cluster.first_vertex, cluster.vertex_count);
  }
  std::span<const std::uint8_t> corners_of(const Cluster& cluster) const {
    return std::span(corners).subspan(cluster.first_index, cluster.index_count);
  }
};

/// Halves the triangles along the longest side of their centres' box until no half has more than kClusterTriangles.
/// `pool`: the threads to do it on, null for the caller's alone; the result is the same.
Clustering make_clusters(const Mesh& mesh, ThreadPool* pool = nullptr);

/// The two steps of it for triangles: the numbers of a mesh's triangles in their new order, which depends on nothing
/// but the mesh; and the clusters of triangles that are in such an order.
std::vector<std::uint32_t> order_in_space(const Mesh& mesh, ThreadPool* pool = nullptr);
Clustering clusters_in_order(const Mesh& mesh, std::span<const std::uint32_t> order);

}  // namespace simvis
