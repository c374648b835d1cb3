// Prepares OBJ files and their material files where Assimp 5.2 would refuse or misread them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "import/programs/assimp_file.h"

namespace simvis {

/// The text without the texture coordinates of faces if faces name some and the file has none, with a warning; nothing
/// if the file can be read as it is. Assimp refuses such files.
std::optional<std::string> prepared_obj(AssimpFile& file);

/// The text with one `d` for each material whose opacity is not what Assimp reads, each with a warning that has the
/// place; nothing if there is no such material. MeshLab writes the opacity as `Tr`; of `d` and `Tr` that contradict
/// each other `d` counts; a material that is wholly transparent is opaque.
std::optional<std::string> prepared_mtl(const std::filesystem::path& mtl, AssimpFile& file);

}  // namespace simvis
