// Meshes and tiles of large meshes with their coarser levels, so that a view can draw what is near and what is far of
// one mesh at different levels.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include <simvis/mesh.h>
#include "engine/geometry/mesh_levels.h"

namespace simvis {

class ThreadPool;

/// A mesh with fewer triangles is one tile.
inline constexpr std::size_t kMinTiledTriangles = 1u << 16;

/// The largest number of triangles of a tile of a larger mesh.
inline constexpr std::size_t kTileTriangles = 1u << 13;

/// A part of a mesh, or all of it.
struct LevelledTile {
  std::shared_ptr<const Mesh> mesh;
  std::vector<MeshLevel> levels;  ///< of the tile, see make_levels()
};

/// A mesh whose parts have fewer triangles than this on average has one tile, since only whole meshes are thinned.
inline constexpr std::size_t kMinTrianglesOfTiledPart = 64;

/// Neighbours in space are in one tile. The borders of tiles are the same at all levels, so that no gap opens between
/// tiles at different levels. A mesh of one tile is not copied. `folder` and `pool` as in make_levels().
std::vector<LevelledTile> make_levelled_tiles(const std::shared_ptr<const Mesh>& mesh,
                                              const std::filesystem::path& folder, ThreadPool* pool = nullptr);

}  // namespace simvis
