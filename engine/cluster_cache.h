// The order of a large mesh's triangles in space, kept on disk between runs.
#pragma once

#include <filesystem>

#include "engine/clusters.h"

namespace simvis {

/// Meshes with fewer triangles are sorted faster than a file is opened.
inline constexpr std::size_t kLeastCachedTriangles = 1u << 16;

/// make_clusters() with what it takes longest for kept in a file, named by what the mesh holds. The file is looked
/// through before it is used: one that is missing, cut off or damaged, or that is of another version, is written anew;
/// whatever it says, every triangle is there once, within its cluster's box. A folder that cannot be written, or an
/// empty name of one, is no error: there is no cache then.
Clustering make_clusters_cached(const Mesh& mesh, const std::filesystem::path& folder);

}  // namespace simvis
