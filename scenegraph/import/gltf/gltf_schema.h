// The shape of the glTF properties that the importer reads, checked before anything interprets them.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

namespace simvis {

/// Checks `root` against the tables of this file's .cpp and leaves in it only what they name: every value has the right
/// JSON type, lies in its range and every index points to something that exists. Numbers are finite as float32 too.
/// Throws InputError, "FILE: error: PLACE ...", with the place as a JSON pointer such as meshes/0/primitives/1/mode.
void check_and_prune_gltf(nlohmann::json& root, const std::filesystem::path& file);

}  // namespace simvis
