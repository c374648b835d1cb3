// Whether a PLY file holds what its header says. Assimp 5.2 believes the header and the indices; where they are wrong
// it may crash, but may as well give a geometry that nobody wrote. So a file is checked first, which also tells the
// place.
#pragma once

#include <filesystem>

namespace simvis {

/// Throws InputError naming the file, with the place in the header and in text: a header that breaks the format, no
/// element `vertex` with x, y and z, elements of one name, a body that is too short (text: or too long), values that
/// are no finite numbers (text), vertex indices out of range. Triangle strips and materials are refused too.
void check_ply(const std::filesystem::path& file);

}  // namespace simvis
