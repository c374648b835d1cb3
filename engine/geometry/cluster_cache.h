// The order of a large mesh's triangles in space, kept on disk between runs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

#include "engine/geometry/clusters.h"
#include "engine/geometry/mesh_cache.h"

namespace simvis {

/// make_clusters() with its slowest step cached in a MeshCacheFile. The cached order is checked before it is used, and
/// computed and written again if it is not valid. For any content of the file, every triangle is in the result once,
/// within its cluster's box. A grid has nothing to sort and no file. `folder`: empty for no cache. `pool` as for
/// make_clusters().
Clustering make_clusters_cached(const Mesh& mesh, const std::filesystem::path& folder, ThreadPool* pool = nullptr);

/// Whether a cached order is one of so many triangles: it holds each of them once.
bool is_order_of(std::span<const std::uint32_t> order, std::size_t triangles);

}  // namespace simvis
