// The tree over a large mesh's triangles, kept on disk between runs.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include <simvis/mesh.h>
#include "engine/geometry/mesh_cache.h"
#include "engine/geometry/wide_bvh.h"

namespace simvis {

/// WideBvh(boxes, leaves) of the mesh's triangles, whose boxes these are; which triangles are together is kept in a
/// MeshCacheFile. That is looked through before it is used, and written anew where it will not do; whatever it says,
/// every triangle is in one leaf, and each box is that of what is below it. `folder`: empty for no cache.
/// `pool` as for build_bvh().
WideBvh make_tree_cached(const Mesh& mesh, std::span<const Box> boxes, std::vector<WideBvh::Leaf>& leaves,
                         const std::filesystem::path& folder, ThreadPool* pool = nullptr);

}  // namespace simvis
