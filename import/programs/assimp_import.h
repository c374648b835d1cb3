// Reads COLLADA files (.dae .zae) with Assimp, after the checks that Assimp leaves out.
#pragma once

#include <filesystem>

#include "import/programs/assimp_file.h"

namespace simvis {

/// Faces may have any number of corners. The scene is converted to Y-up and metres by the file's <up_axis> and <unit>;
/// with `ignore_up_axis` only by its <unit>.
/// Throws InputError naming the file, and the place if known, if the file cannot be read, is too large, cut off or
/// malformed.
AssimpFile read_assimp_file(const std::filesystem::path& file, bool ignore_up_axis);

}  // namespace simvis
