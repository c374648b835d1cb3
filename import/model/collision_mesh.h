// The mesh files of collisions.
#pragma once

#include <filesystem>
#include <memory>

#include <simvis/content_pool.h>
#include <simvis/node.h>

namespace simvis {

/// The meshes of a file with its axes as written; null: it has none. Throws InputError for a file that is broken.
std::shared_ptr<const Group> read_collision_mesh(const std::filesystem::path& file, ContentPool& pool);

}  // namespace simvis
