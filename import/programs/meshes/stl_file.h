// Reads STL files.
#pragma once

#include <filesystem>

#include "import/sandbox/imported_scene.h"

namespace simvis {

/// Reads text, with a node for each solid, or binary STL, with the colours of VisCAM, SolidView or Magics: where one
/// facet has a colour, those without have that of the header, or grey. Facets that are marked as coloured while every
/// colour is 0 have none, with a warning, because some programs set the mark but never a colour. Throws InputError
/// naming the file if it is neither binary STL with the length that its number of facets requires, nor text that begins
/// with "solid" and ends with "endsolid"; with the line for facets of less than three vertices and for words in place
/// of numbers.
ImportedScene read_stl(const std::filesystem::path& file);

}  // namespace simvis
