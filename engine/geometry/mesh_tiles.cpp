#include "engine/geometry/mesh_tiles.h"

#include <meshoptimizer.h>

#include <algorithm>

#include "engine/base/thread_pool.h"
#include "engine/geometry/clusters.h"
#include "engine/geometry/submesh.h"
#include "engine/geometry/thinning.h"

namespace simvis {
namespace {

bool is_tiled(const Mesh& mesh) {
  const std::size_t triangles = mesh.indices.size() / 3, vertices = mesh.positions.size();
  if (mesh.topology != Topology::triangles || mesh.short_lived || triangles < kMinTiledTriangles) return false;
  // Vertices at one place may differ in their attributes.
  std::vector<std::uint32_t> place_of(vertices), places(mesh.indices.size());
  meshopt_generateVertexRemap(place_of.data(), nullptr, vertices, mesh.positions.data(), vertices, sizeof(glm::vec3));
  std::ranges::transform(mesh.indices, places.begin(), [&](std::uint32_t vertex) { return place_of[vertex]; });
  return count_parts(vertices, places) * kMinTrianglesOfTiledPart <= triangles;
}

// `order` is that of order_in_space(), whose halves are halves in space.
void add_tiles(const Mesh& mesh, std::span<const std::uint32_t> order, std::vector<LevelledTile>& tiles) {
  if (order.size() > kTileTriangles) {
    add_tiles(mesh, order.first(order.size() / 2), tiles);
    add_tiles(mesh, order.subspan(order.size() / 2), tiles);
    return;
  }
  std::vector<std::uint32_t> indices;
  for (const std::size_t triangle : order) {
    const auto corners = std::span(mesh.indices).subspan(3 * triangle, 3);
    indices.insert(indices.end(), corners.begin(), corners.end());
  }
  tiles.push_back({submesh(mesh, mesh.positions, indices), {}});
}

}  // namespace

std::vector<LevelledTile> make_levelled_tiles(const std::shared_ptr<const Mesh>& mesh,
                                              const std::filesystem::path& folder, ThreadPool* pool) {
  if (!is_tiled(*mesh)) return {{mesh, make_levels(*mesh, LevelBorders::free, folder, pool)}};
  std::vector<LevelledTile> tiles;
  add_tiles(*mesh, order_in_space(*mesh, pool), tiles);
  const auto make = [&](std::size_t, std::size_t first, std::size_t count) {
    for (LevelledTile& tile : std::span(tiles).subspan(first, count)) {
      tile.levels = make_levels(*tile.mesh, LevelBorders::kept, folder, pool);
    }
  };
  if (pool == nullptr) {
    make(0, 0, tiles.size());
  } else {
    pool->parallel_for(tiles.size(), 1, make);
  }
  return tiles;
}

}  // namespace simvis
