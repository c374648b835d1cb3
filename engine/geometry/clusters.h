// Meshes divided into clusters, so that a view draws only those parts of a mesh that may be visible.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include <simvis/mesh.h>

namespace simvis {

class ThreadPool;

/// A range of triangles and their bounding box, in the mesh's frame.
struct Cluster {
  std::uint32_t first_index = 0, index_count = 0;
  std::uint32_t first_corner = 0;                    ///< in Clustering::corners, as many as indices
  std::uint32_t first_vertex = 0, vertex_count = 0;  ///< range in Clustering::vertices
  std::uint32_t base = 0;                            ///< is added to these
  glm::vec3 center{0}, half_size{0};                 ///< rounded outwards
};

/// The largest number of triangles in a cluster. Smaller clusters fit a view more closely and cost more tests and
/// draws.
inline constexpr std::size_t kClusterTriangles = 32;

/// The vertices of a cluster: indices of vertices of the mesh.
struct ClusterVertices {
  std::span<const std::uint32_t> offsets;  ///< from `base`
  std::uint32_t base = 0;

  std::size_t size() const { return offsets.size(); }
  std::uint32_t operator[](std::size_t i) const { return base + offsets[i]; }
};

/// A mesh's triangles in an order in which neighbours in space are neighbours in the list; those of a short-lived mesh
/// in their own order, which costs less than sorting them. The clusters cover the list without gaps, and each triangle
/// keeps the order of its corners. Lines and points have one cluster, in the mesh's own order, and neither vertices nor
/// corners.
///
/// Triangles of a cluster share most of their vertices, so each vertex is listed once and corners refer to it. This
/// takes half the memory of a list of indices, and a vertex need not be processed for each of its triangles. In a grid,
/// clusters of as many columns and rows differ in their base alone, and share their vertices and corners.
struct Clustering {
  std::vector<Cluster> clusters;
  std::vector<std::uint32_t> vertices;  ///< indices of the mesh's vertices, less the cluster's base
  std::vector<std::uint8_t> corners;    ///< one for each index: its position among the cluster's vertices

  ClusterVertices vertices_of(const Cluster& cluster) const {
    return {std::span(vertices).subspan(cluster.first_vertex, cluster.vertex_count), cluster.base};
  }
  std::span<const std::uint8_t> corners_of(const Cluster& cluster) const {
    return std::span(corners).subspan(cluster.first_corner, cluster.index_count);
  }
};

/// Halves the triangles along the longest side of their centres' box until no half has more than kClusterTriangles; the
/// cells of a grid (grid_mesh.h) along the longer side of their rectangle. `pool` has the threads to use, null for the
/// calling thread alone; the result does not depend on it.
Clustering make_clusters(const Mesh& mesh, ThreadPool* pool = nullptr);

/// The two steps of make_clusters() for triangles. order_in_space() returns the numbers of a mesh's triangles in their
/// new order, which depends only on the mesh. clusters_in_order() makes clusters of triangles in such an order.
std::vector<std::uint32_t> order_in_space(const Mesh& mesh, ThreadPool* pool = nullptr);
Clustering clusters_in_order(const Mesh& mesh, std::span<const std::uint32_t> order);

}  // namespace simvis
