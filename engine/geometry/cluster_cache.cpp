#include "engine/geometry/cluster_cache.h"

#include <vector>

#include "engine/draw/grid_mesh.h"

namespace simvis {
namespace {

// The version of the result of order_in_space().
constexpr char kClustersVersion = '1';

}  // namespace

bool is_order_of(std::span<const std::uint32_t> order, std::size_t triangles) {
  if (order.size() != triangles) return false;
  std::vector<bool> seen(triangles);
  for (const std::uint32_t triangle : order) {
    if (triangle >= triangles || seen[triangle]) return false;
    seen[triangle] = true;
  }
  return true;
}

Clustering make_clusters_cached(const Mesh& mesh, const std::filesystem::path& folder, ThreadPool* pool) {
  const std::size_t triangles = mesh.indices.size() / 3;
  if (folder.empty() || mesh.topology != Topology::triangles || mesh.short_lived || triangles < kMinCachedTriangles ||
      find_grid(mesh)) {
    return make_clusters(mesh, pool);
  }
  const MeshCacheFile file(folder, "clusters", kClustersVersion, mesh);
  std::vector<std::uint32_t> order = file.read();
  if (!is_order_of(order, triangles)) {
    order = order_in_space(mesh, pool);
    file.write(order);
  }
  return clusters_in_order(mesh, order);
}

}  // namespace simvis
