// Checks the JSON structure of the glTF properties that the importer reads, before anything interprets them.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

namespace simvis {

/// Checks `root` against the tables in gltf_schema.cpp and removes everything that they do not name. Afterwards every
/// value has the right JSON type and lies in its range, every index is valid, and numbers are finite as float32 too.
/// Throws InputError "FILE: error: PLACE ...", with the place as a JSON pointer such as meshes/0/primitives/1/mode.
void check_and_prune_gltf(nlohmann::json& root, const std::filesystem::path& file);

}  // namespace simvis
