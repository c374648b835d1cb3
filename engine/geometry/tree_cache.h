// The tree over a large mesh's triangles, kept on disk between runs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include <simvis/mesh.h>
#include "engine/geometry/mesh_cache.h"
#include "engine/geometry/wide_bvh.h"

namespace simvis {

/// WideBvh(boxes, leaves) over the mesh's triangles, which have these boxes. A MeshCacheFile keeps the topology of the
/// tree. It is checked before it is used, and computed and written again if it is not valid. For any content of the
/// file, every triangle is in one leaf, and each box is that of the content below it. `folder`: empty for no cache.
/// `pool` as for build_bvh().
WideBvh make_tree_cached(const Mesh& mesh, std::span<const Box> boxes, std::vector<WideBvh::Leaf>& leaves,
                         const std::filesystem::path& folder, ThreadPool* pool = nullptr);

/// The tree that the words of a cached file stand for, over triangles with these boxes; empty if it is not valid. For
/// any words, what is true of make_tree_cached() holds.
std::optional<WideBvh> read_cached_tree(std::span<const std::uint32_t> words, std::span<const Box> boxes,
                                        std::vector<WideBvh::Leaf>& leaves);

}  // namespace simvis
