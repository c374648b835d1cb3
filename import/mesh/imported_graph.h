// Turns an imported scene into a graph of nodes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <simvis/content_pool.h>
#include <simvis/node.h>
#include "import/sandbox/imported_scene.h"

namespace simvis {

/// (x, y, z) -> (x, -z, y): from a y-up frame to SimVis's z-up frame.
inline constexpr glm::dmat4 kZUpFromYUp(1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1);

/// Adds a separator for each node, with its transform, its light and its shapes. Textures, materials and meshes go
/// through the pool. Picture files are found as find_and_read_picture() does; the warnings about them are returned.
/// `fallback` replaces missing materials.
std::vector<std::string> add_imported_scene(ImportedScene&& scene, const std::filesystem::path& file,
                                            const Material& fallback, ContentPool& pool, Group& root);

}  // namespace simvis
