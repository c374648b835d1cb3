// Whether an STL file is whole: Assimp takes what is left of one that was cut off.
#pragma once

#include <filesystem>

namespace simvis {

/// Throws InputError naming the file: neither binary STL of the length that its count of facets asks for, nor text that
/// begins with "solid" and ends with "endsolid".
void check_stl(const std::filesystem::path& file);

}  // namespace simvis
