// Reads mesh files (.dae .zae .obj) with Assimp, after the checks that Assimp leaves out.
#pragma once

#include <filesystem>

#include "import/programs/assimp_file.h"

namespace simvis {

/// Faces may have any number of corners. COLLADA is converted to Y-up and metres by its <up_axis> and <unit>; with
/// `ignore_up_axis` only by its <unit>. Other formats are not converted.
/// Throws InputError naming the file, and the place if known, if the file cannot be read, is too large, cut off or
/// malformed.
AssimpFile read_assimp_file(const std::filesystem::path& file, bool ignore_up_axis);

}  // namespace simvis
