#include "engine/clusters.h"

#include <algorithm>
#include <limits>
#include <numeric>

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

// Triangle numbers in their new order, and where each cluster ends in it.
struct Order {
  std::vector<std::uint32_t> triangles;
  std::vector<std::size_t> ends;
};

Order order_in_space(const Mesh& mesh) {
  const std::size_t count = mesh.indices.size() / 3;
  std::vector<glm::vec3> centers(count);
  for (std::size_t t = 0; t < count; ++t) {
    for (int corner = 0; corner < 3; ++corner) centers[t] += mesh.positions[mesh.indices[3 * t + corner]] / 3.0f;
  }
  Order order;
  order.triangles.resize(count);
  std::iota(order.triangles.begin(), order.triangles.end(), 0u);
  std::vector<std::pair<std::size_t, std::size_t>> open{{0, count}};
  while (!open.empty()) {
    const auto [first, end] = open.back();
    open.pop_back();
    if (end - first <= kClusterTriangles) {
      order.ends.push_back(end);
      continue;
    }
    Box box;
    for (std::size_t i = first; i < end; ++i) box.add(centers[order.triangles[i]]);
    const glm::vec3 size = box.high - box.low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::size_t middle = (first + end) / 2;
    const auto at = order.triangles.begin();
    std::nth_element(at + static_cast<std::ptrdiff_t>(first), at + static_cast<std::ptrdiff_t>(middle),
                     at + static_cast<std::ptrdiff_t>(end), [&](std::uint32_t a, std::uint32_t b) {
                       return centers[a][axis] != centers[b][axis] ? centers[a][axis] < centers[b][axis] : a < b;
                     });
    open.emplace_back(middle, end);  // the first half comes off first, so that clusters end in ascending order
    open.emplace_back(first, middle);
  }
  return order;
}

}  // namespace

ClusteredIndices make_clusters(const Mesh& mesh) {
  ClusteredIndices result;
  if (mesh.topology != Topology::triangles || mesh.indices.size() <= 3 * kClusterTriangles) {
    result.indices = mesh.indices;
    result.clusters.push_back(make_cluster(mesh, result.indices, 0, result.indices.size()));
    return result;
  }
  const Order order = order_in_space(mesh);
  result.indices.reserve(mesh.indices.size());
  for (const std::uint32_t t : order.triangles) {
    for (int corner = 0; corner < 3; ++corner) result.indices.push_back(mesh.indices[3 * t + corner]);
  }
  std::size_t first = 0;
  for (const std::size_t end : order.ends) {
    result.clusters.push_back(make_cluster(mesh, result.indices, 3 * first, 3 * end));
    first = end;
  }
  return result;
}

}  // namespace simvis
