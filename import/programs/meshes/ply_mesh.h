// Meshes of PLY files, and the choice among what such files hold.
#pragma once

#include <filesystem>

#include "import/sandbox/imported_scene.h"

namespace simvis {

/// Reads the faces or triangle strips of a PLY file, its points or its splats (clouds/cloud_files.h). Other elements
/// are read over. Colours of whole numbers are sRGB from 0 to 255 in one byte, else to 65535. Throws InputError naming
/// the file, and the place in the header or in text: for a header that breaks the format, elements that hold nothing,
/// a body that does not fit the header, values that are not finite, and vertices that are not in the file.
ImportedScene read_ply(const std::filesystem::path& file);

}  // namespace simvis
