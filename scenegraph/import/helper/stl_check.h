// Checks that an STL file is complete. Assimp accepts the rest of a file that was cut off.
#pragma once

#include <filesystem>

namespace simvis {

/// Throws InputError naming the file if it is neither binary STL with the length that its number of facets requires,
/// nor text that begins with "solid" and ends with "endsolid".
void check_stl(const std::filesystem::path& file);

}  // namespace simvis
