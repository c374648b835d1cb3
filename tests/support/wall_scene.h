// A small scene on disk: a white wall of 20 m x 20 m, perpendicular to x at x = 4 m.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "tests/support/temporary_folder.h"

namespace simvis {

/// In glTF's own axes (y up; x stays x on import, y becomes z and z becomes -y): two triangles that face -x.
std::string wall_gltf();

inline constexpr std::string_view kWallPart = R"(<part file="wall.gltf" name="WALL" insert_at="ROOT"/>)";

/// Writes wall.gltf and scene.xml with the wall and `commands`; returns the scene's path.
std::filesystem::path write_wall_scene(const std::filesystem::path& folder, std::string_view commands);

}  // namespace simvis
