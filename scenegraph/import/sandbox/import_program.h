// Where the programs are that read part files for SimVis.
#pragma once

#include <filesystem>
#include <string_view>

namespace simvis {

/// The program of that name in the folder `simvis` beside the library libsimvis: so it stands in a build tree, and so
/// it is installed. Whether it is there is not looked at.
std::filesystem::path import_program(std::string_view name);

}  // namespace simvis
