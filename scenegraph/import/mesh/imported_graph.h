// Turns an imported scene into a graph of nodes.
#pragma once

#include <filesystem>

#include <simvis/content_pool.h>
#include <simvis/node.h>
#include "scenegraph/import/sandbox/imported_scene.h"

namespace simvis {

/// Adds a separator for each node, with its transform, its light and its shapes. Textures, materials and meshes go
/// through the pool. Picture files are read relative to the folder of `file`. `fallback` replaces missing materials.
/// Throws InputError naming a picture that is missing or broken.
void add_imported_scene(ImportedScene&& scene, const std::filesystem::path& file, const Material& fallback,
                        ContentPool& pool, Group& root);

}  // namespace simvis
