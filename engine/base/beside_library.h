// Finds the files that belong to the library and lie beside it.
#pragma once

#include <filesystem>
#include <string_view>

namespace simvis {

/// Returns the path of a file in the folder `simvis` beside the library libsimvis, in a build tree and in an
/// installation. Does not check that the file exists.
std::filesystem::path beside_library(std::string_view name);

}  // namespace simvis
