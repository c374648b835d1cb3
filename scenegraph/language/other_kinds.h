// Kinds of files that SimVis does not read and another program converts.
#pragma once

#include <filesystem>
#include <string>

namespace simvis {

/// "; Blender converts FBX to .glb", by the file's ending in any case; empty for other endings.
std::string converter_of(const std::filesystem::path& file);

}  // namespace simvis
