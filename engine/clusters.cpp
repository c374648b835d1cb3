#include "engine/clusters.h"

#include <algorithm>
#include <future>
#include <limits>
#include <span>
#include <thread>

namespace simvis {
namespace {

struct Box {
  glm::vec3 low{std::numeric_limits<float>::infinity()}, high{-std::numeric_limits<float>::infinity()};

  void add(const glm::vec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
};

Cluster make_cluster(const Mesh& mesh, const std::vector<std::uint32_t>& indices, std::size_t first, std::size_t end) {
  Box box;
  for (std::size_t i = first; i < end; ++i) box.add(mesh.positions[indices[i]]);
  // Sums of float32 lose half an ulp each; two of the larger corner make up for it.
  constexpr float kOutwards = 2 * std::numeric_limits<float>::epsilon();
  const glm::vec3 slack = kOutwards * glm::max(glm::abs(box.low), glm::abs(box.high));
  return {.first_index = static_cast<std::uint32_t>(first),
          .index_count = static_cast<std::uint32_t>(end - first),
          .center = 0.5f * (box.low + box.high),
          .half_size = 0.5f * (box.high - box.low) + slack};
}

// What is sorted, with all that sorting looks at: to follow numbers through memory would take most of the time.
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

// Puts the smaller half, along the longest side of the centres' box, in front of the larger one.
void halve(std::span<Placed> placed) {
  Box box;
  for (const Placed& each : placed) box.add(each.center);
  const glm::vec3 size = box.high - box.low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::nth_element(placed.begin(), placed.begin() + static_cast<std::ptrdiff_t>(placed.size() / 2), placed.end(),
                   [axis](const Placed& a, const Placed& b) {
                     return a.center[axis] != b.center[axis] ? a.center[axis] < b.center[axis]
                                                             : a.triangle < b.triangle;
                   });
}

// A half has nothing to do with the other one: however many threads sort them, the order is the same.
void sort_in_space(std::span<Placed> placed, unsigned threads) {
  if (placed.size() <= kClusterTriangles) return;
  halve(placed);
  const std::span<Placed> front = placed.first(placed.size() / 2), back = placed.subspan(placed.size() / 2);
  constexpr std::size_t kWorthAThread = 1u << 14;
  std::future<void> other;
  if (threads > 1 && placed.size() >= kWorthAThread) {
    other = std::async(std::launch::async, [back, threads] { sort_in_space(back, threads / 2); });
  }
  sort_in_space(front, threads - threads / 2);
  if (!other.valid()) sort_in_space(back, 1);
}

// How many triangles each cluster has, in order, follows from how many there are in all.
void add_cluster_sizes(std::size_t triangles, std::vector<std::size_t>& sizes) {
  if (triangles <= kClusterTriangles) return sizes.push_back(triangles);
  add_cluster_sizes(triangles / 2, sizes);
  add_cluster_sizes(triangles - triangles / 2, sizes);
}

}  // namespace

std::vector<std::uint32_t> order_in_space(const Mesh& mesh) {
  std::vector<Placed> placed = place(mesh);
  sort_in_space(placed, std::max(1u, std::thread::hardware_concurrency()));
  std::vector<std::uint32_t> order;
  order.reserve(placed.size());
  for (const Placed& each : placed) order.push_back(each.triangle);
  return order;
}

ClusteredIndices clusters_in_order(const Mesh& mesh, std::span<const std::uint32_t> order) {
  ClusteredIndices result;
  result.indices.reserve(mesh.indices.size());
  for (const std::size_t triangle : order) {
    for (int corner = 0; corner < 3; ++corner) result.indices.push_back(mesh.indices[3 * triangle + corner]);
  }
  std::vector<std::size_t> sizes;
  add_cluster_sizes(order.size(), sizes);
  result.clusters.reserve(sizes.size());
  std::size_t first = 0;
  for (const std::size_t size : sizes) {
    result.clusters.push_back(make_cluster(mesh, result.indices, 3 * first, 3 * (first + size)));
    first += size;
  }
  return result;
}

ClusteredIndices make_clusters(const Mesh& mesh) {
  if (mesh.topology == Topology::triangles && mesh.indices.size() > 3 * kClusterTriangles) {
    return clusters_in_order(mesh, order_in_space(mesh));
  }
  ClusteredIndices result;
  result.indices = mesh.indices;
  result.clusters.push_back(make_cluster(mesh, result.indices, 0, result.indices.size()));
  return result;
}

}  // namespace simvis
