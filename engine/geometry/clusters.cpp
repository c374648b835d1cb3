#include "engine/geometry/clusters.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "engine/base/thread_pool.h"
#include "engine/draw/grid_mesh.h"

namespace simvis {
namespace {

struct PointBox {
  glm::vec3 low{std::numeric_limits<float>::infinity()}, high{-std::numeric_limits<float>::infinity()};

  void add(const glm::vec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
};

// A cluster with this box and without triangles.
Cluster cluster_in(const PointBox& box) {
  // Each float32 sum loses half an ulp; two ulps of the larger corner compensate for that.
  constexpr float kOutwards = 2 * std::numeric_limits<float>::epsilon();
  const glm::vec3 slack = kOutwards * glm::max(glm::abs(box.low), glm::abs(box.high));
  Cluster cluster;
  cluster.center = 0.5f * (box.low + box.high);
  cluster.half_size = 0.5f * (box.high - box.low) + slack;
  return cluster;
}

class ClusterWriter {
 public:
  explicit ClusterWriter(const Mesh& mesh) : mesh_(mesh), place_(mesh.positions.size()) {}

  void add(std::span<const std::uint32_t> triangles, Clustering& clustering) {
    static_assert(3 * kClusterTriangles <= std::numeric_limits<std::uint8_t>::max() + 1);
    std::vector<std::uint32_t>& vertices = clustering.vertices;
    const auto first_index = static_cast<std::uint32_t>(clustering.corners.size());
    const auto first_vertex = static_cast<std::uint32_t>(vertices.size());
    PointBox box;
    for (const std::size_t triangle : triangles) {
      for (const std::uint32_t vertex : std::span(mesh_.indices).subspan(3 * triangle, 3)) {
        std::uint32_t& place = place_[vertex];
        if (place < first_vertex || place >= vertices.size() || vertices[place] != vertex) {
          place = static_cast<std::uint32_t>(vertices.size());
          vertices.push_back(vertex);
          box.add(mesh_.positions[vertex]);
        }
        clustering.corners.push_back(static_cast<std::uint8_t>(place - first_vertex));
      }
    }
    Cluster& cluster = clustering.clusters.emplace_back(cluster_in(box));
    cluster.first_index = cluster.first_corner = first_index;
    cluster.index_count = static_cast<std::uint32_t>(clustering.corners.size()) - first_index;
    cluster.first_vertex = first_vertex;
    cluster.vertex_count = static_cast<std::uint32_t>(vertices.size()) - first_vertex;
  }

 private:
  const Mesh& mesh_;
  std::vector<std::uint32_t> place_;  // by vertex: its last position in Clustering::vertices, if it has one
};

// An element to sort, with all data that sorting reads: indirect memory accesses would take most of the time.
struct Placed {
  glm::vec3 center{0};
  std::uint32_t triangle = 0;
};

std::vector<Placed> place(const Mesh& mesh) {
  std::vector<Placed> placed(mesh.indices.size() / 3);
  for (std::size_t t = 0; t < placed.size(); ++t) {
    placed[t].triangle = static_cast<std::uint32_t>(t);
    for (int corner = 0; corner < 3; ++corner) {
      placed[t].center += mesh.positions[mesh.indices[3 * t + corner]] / 3.0f;
    }
  }
  return placed;
}

// Moves the half with the smaller coordinates, along the longest side of the centres' box, in front of the other half.
void halve(std::span<Placed> placed) {
  PointBox box;
  for (const Placed& each : placed) box.add(each.center);
  const glm::vec3 size = box.high - box.low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::nth_element(placed.begin(), placed.begin() + static_cast<std::ptrdiff_t>(placed.size() / 2), placed.end(),
                   [axis](const Placed& a, const Placed& b) {
                     return a.center[axis] != b.center[axis] ? a.center[axis] < b.center[axis]
                                                             : a.triangle < b.triangle;
                   });
}

// The halves are independent, so the order does not depend on the number of threads that sort them.
void sort_in_space(std::span<Placed> placed, ThreadPool* pool) {
  if (placed.size() <= kClusterTriangles) return;
  halve(placed);
  const std::span<Placed> front = placed.first(placed.size() / 2), back = placed.subspan(placed.size() / 2);
  constexpr std::size_t kWorthAThread = 1u << 14;
  if (pool != nullptr && placed.size() >= kWorthAThread) {
    return pool->parallel_both([&] { sort_in_space(front, pool); }, [&] { sort_in_space(back, pool); });
  }
  sort_in_space(front, nullptr);
  sort_in_space(back, nullptr);
}

// Cells of a grid in columns and rows from `low` to before `high`.
struct CellRange {
  glm::uvec2 low{0}, high{0};

  std::uint32_t count() const { return (high.x - low.x) * (high.y - low.y); }
};

std::uint32_t end_of(const Cluster& cluster) { return cluster.first_index + cluster.index_count; }

// Makes the clusters of a grid.
class GridClusters {
 public:
  GridClusters(const Mesh& mesh, const GridSize& grid) : mesh_(mesh), grid_(grid) {
    add({{0, 0}, {grid.columns - 1, grid.rows - 1}});
    result_.clusters.shrink_to_fit();
    result_.vertices.shrink_to_fit();
    result_.corners.shrink_to_fit();
  }

  Clustering take() { return std::move(result_); }

 private:
  std::uint32_t vertex_at(std::uint32_t column, std::uint32_t row) const { return row * grid_.columns + column; }
  void add(const CellRange& cells);
  void add_cluster(const CellRange& cells);
  std::size_t find_pattern(const glm::uvec2& size);

  // The vertices and corners that clusters of a size share.
  struct Pattern {
    glm::uvec2 size{0};  // in cells
    std::uint32_t first_corner = 0, first_vertex = 0;
  };

  const Mesh& mesh_;
  GridSize grid_;
  std::vector<Pattern> patterns_;
  Clustering result_;
};

// Halves cells along the longer side of their rectangle until a cluster holds them.
void GridClusters::add(const CellRange& cells) {
  if (2 * cells.count() <= kClusterTriangles) return add_cluster(cells);
  const auto at = [&](const glm::uvec2& cell) { return glm::vec2(mesh_.positions[vertex_at(cell.x, cell.y)]); };
  const glm::uvec2 numbers = cells.high - cells.low;
  const glm::vec2 size = glm::abs(at(cells.high) - at(cells.low));
  const int axis = numbers.y < 2 || (numbers.x >= 2 && size.x >= size.y) ? 0 : 1;
  CellRange front = cells, back = cells;
  front.high[axis] = back.low[axis] = cells.low[axis] + numbers[axis] / 2;
  add(front);
  add(back);
}

void GridClusters::add_cluster(const CellRange& cells) {
  const glm::uvec2 size = cells.high - cells.low;
  const Pattern& pattern = patterns_[find_pattern(size)];
  PointBox box;
  for (std::uint32_t row = cells.low.y; row <= cells.high.y; ++row) {
    for (std::uint32_t column = cells.low.x; column <= cells.high.x; ++column) {
      box.add(mesh_.positions[vertex_at(column, row)]);
    }
  }
  const std::uint32_t first_index = result_.clusters.empty() ? 0 : end_of(result_.clusters.back());
  Cluster& cluster = result_.clusters.emplace_back(cluster_in(box));
  cluster.first_index = first_index;
  cluster.index_count = 6 * cells.count();
  cluster.first_corner = pattern.first_corner;
  cluster.first_vertex = pattern.first_vertex;
  cluster.vertex_count = (size.x + 1) * (size.y + 1);
  cluster.base = vertex_at(cells.low.x, cells.low.y);
}

// Makes the pattern of the first cluster of a size.
std::size_t GridClusters::find_pattern(const glm::uvec2& size) {
  const auto known = std::ranges::find(patterns_, size, &Pattern::size);
  if (known != patterns_.end()) return static_cast<std::size_t>(known - patterns_.begin());
  patterns_.push_back(
      {size, static_cast<std::uint32_t>(result_.corners.size()), static_cast<std::uint32_t>(result_.vertices.size())});
  for (std::uint32_t row = 0; row <= size.y; ++row) {
    for (std::uint32_t column = 0; column <= size.x; ++column) result_.vertices.push_back(vertex_at(column, row));
  }
  for (std::uint32_t row = 0; row < size.y; ++row) {
    for (std::uint32_t column = 0; column < size.x; ++column) {
      const std::uint32_t a = row * (size.x + 1) + column, b = a + size.x + 1;
      for (const std::uint32_t corner : {a, b, b + 1, a, b + 1, a + 1}) {
        result_.corners.push_back(static_cast<std::uint8_t>(corner));
      }
    }
  }
  return patterns_.size() - 1;
}

// Appends the number of triangles of each cluster, in order. It depends only on the total number of triangles.
void add_cluster_sizes(std::size_t triangles, std::vector<std::size_t>& sizes) {
  if (triangles <= kClusterTriangles) return sizes.push_back(triangles);
  add_cluster_sizes(triangles / 2, sizes);
  add_cluster_sizes(triangles - triangles / 2, sizes);
}

}  // namespace

std::vector<std::uint32_t> order_in_space(const Mesh& mesh, ThreadPool* pool) {
  if (mesh.short_lived) {
    std::vector<std::uint32_t> order(mesh.indices.size() / 3);
    std::iota(order.begin(), order.end(), 0u);
    return order;
  }
  std::vector<Placed> placed = place(mesh);
  sort_in_space(placed, pool);
  std::vector<std::uint32_t> order;
  order.reserve(placed.size());
  for (const Placed& each : placed) order.push_back(each.triangle);
  return order;
}

Clustering clusters_in_order(const Mesh& mesh, std::span<const std::uint32_t> order) {
  Clustering result;
  std::vector<std::size_t> sizes;
  add_cluster_sizes(order.size(), sizes);
  result.clusters.reserve(sizes.size());
  result.corners.reserve(3 * order.size());
  result.vertices.reserve(order.size());
  ClusterWriter writer(mesh);
  std::size_t first = 0;
  for (const std::size_t size : sizes) {
    writer.add(order.subspan(first, size), result);
    first += size;
  }
  result.vertices.shrink_to_fit();
  return result;
}

Clustering make_clusters(const Mesh& mesh, ThreadPool* pool) {
  if (mesh.topology == Topology::triangles) {
    if (const auto grid = find_grid(mesh)) return GridClusters(mesh, *grid).take();  // nothing has to be sorted
    return clusters_in_order(mesh, order_in_space(mesh, pool));
  }
  PointBox box;
  for (const std::uint32_t vertex : mesh.indices) box.add(mesh.positions[vertex]);
  Clustering result;
  result.clusters.push_back(cluster_in(box));
  result.clusters[0].index_count = static_cast<std::uint32_t>(mesh.indices.size());
  return result;
}

}  // namespace simvis
