// Checks that an STL file is complete. Assimp accepts the rest of a file that was cut off.
#pragma once

#include "import/programs/assimp_file.h"

namespace simvis {

/// Throws InputError naming the file if it is neither binary STL with the length that its number of facets requires,
/// nor text that begins with "solid" and ends with "endsolid".
/// Returns whether the colours that Assimp reads are none: some programs set the bit that marks a facet as coloured,
/// but never a colour, and Assimp then returns black.
bool check_stl(AssimpFile& file);

}  // namespace simvis
