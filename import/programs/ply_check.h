// Checks a PLY file against its header. Assimp 5.2 does not check the header and the indices. If they are wrong, it may
// crash or return geometry that is not in the file. This check runs before Assimp and also gives the place of an error.
#pragma once

#include <optional>
#include <string>

#include "import/programs/assimp_file.h"

namespace simvis {

/// The file has its bytes. Throws InputError naming the file, and the place in the header or in a text body, for a
/// header that breaks the format, no element `vertex` with x, y and z, two elements of the same name, a body that is
/// too short (or too long, if it is text), values that are not finite numbers (text), and vertex indices out of range.
/// Triangle strips and materials are refused too. Lines of the header that are not understood are left out, each with a
/// warning. Returns the bytes that Assimp must read in place of the file, if it would misread the file: Assimp 5.2
/// expects the format in the second line, and drops a first byte of binary data that is a line feed.
std::optional<std::string> check_ply(AssimpFile& file);

}  // namespace simvis
