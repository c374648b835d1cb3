// Finds the programs that read part files for SimVis.
#pragma once

#include <filesystem>
#include <string_view>

namespace simvis {

/// Returns the path of the program in the folder `simvis` beside the library libsimvis, in a build tree and in an
/// installation. Does not check that the program exists.
std::filesystem::path import_program(std::string_view name);

}  // namespace simvis
