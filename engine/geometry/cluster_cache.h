// The order of a large mesh's triangles in space, kept on disk between runs.
#pragma once

#include <filesystem>

#include "engine/geometry/clusters.h"
#include "engine/geometry/mesh_cache.h"

namespace simvis {

/// make_clusters() with what it takes longest for kept in a MeshCacheFile. That is looked through before it is used,
/// and written anew where it will not do; whatever it says, every triangle is there once, within its cluster's box.
/// `folder`: empty for no cache. `pool` as for make_clusters().
Clustering make_clusters_cached(const Mesh& mesh, const std::filesystem::path& folder, ThreadPool* pool = nullptr);

}  // namespace simvis
