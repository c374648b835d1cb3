// Whether a PLY file holds what its header says. Assimp 5.2 believes the header and the indices, and writes beyond its
// buffers where they are wrong; so a file is walked through before it gets there.
#pragma once

#include <filesystem>

namespace simvis {

/// Throws InputError naming the file, with the place in the header and in text: a header that breaks the format, no
/// element `vertex` with x, y and z, elements of one name, a body that is too short (text: or too long), values that
/// are no finite numbers (text), vertex indices out of range. Triangle strips and materials are refused too.
void check_ply(const std::filesystem::path& file);

}  // namespace simvis
