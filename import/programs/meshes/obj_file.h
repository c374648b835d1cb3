// Reads Wavefront OBJ files with their material files.
#pragma once

#include <filesystem>

#include "import/sandbox/imported_scene.h"

namespace simvis {

/// One node for the file, and below it one for each `o` and `g`. Faces that follow each other with one material are one
/// mesh. Diffuse colour, opacity, emission and the diffuse picture of materials are used; colours are read as sRGB.
/// Materials are double-sided but for faces that lie back to back (back_to_back.h). A file without faces is a cloud of
/// its vertices. A missing material file is a warning; then that with the name of the OBJ file is taken, if there is
/// one. Throws InputError as read_obj_text() and read_mtl().
ImportedScene read_obj(const std::filesystem::path& file);

}  // namespace simvis
