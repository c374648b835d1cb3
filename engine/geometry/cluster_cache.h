// The order of a large mesh's triangles in space, kept on disk between runs.
#pragma once

#include <filesystem>

#include "engine/geometry/clusters.h"
#include "engine/geometry/mesh_cache.h"

namespace simvis {

/// make_clusters() with its slowest step cached in a MeshCacheFile. The cached order is checked before it is used, and
/// computed and written again if it is not valid. For any content of the file, every triangle is in the result once,
/// within its cluster's box. `folder`: empty for no cache. `pool` as for make_clusters().
Clustering make_clusters_cached(const Mesh& mesh, const std::filesystem::path& folder, ThreadPool* pool = nullptr);

}  // namespace simvis
