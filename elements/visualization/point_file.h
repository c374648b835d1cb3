// Points from a text file.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <vector>

namespace simvis {

struct FilePoint {
  glm::dvec3 position_m{0};
  glm::vec3 color{1};  ///< linear RGB; white where the file has none
};

struct PointFile {
  std::vector<FilePoint> points;
  bool has_colors = false;
};

/// A file may hold as many.
inline constexpr std::size_t kMaxPoints = 1'000'000;

/// One point a line: "x y z" or "x y z r g b", separated by spaces, commas or both; metres, and colours from 0 to 255
/// as pictures have them (sRGB). Either each line has a colour or none. Empty lines and lines that start with '#' are
/// passed over, and a first line "x,y,z" or "x,y,z,r,g,b" too.
/// Throws InputError with FILE:LINE:COLUMN: what is no point, a coordinate beyond kMaxCoordinate_m, no points at all or
/// too many, not UTF-8 text, a file that cannot be read.
PointFile read_point_file(const std::filesystem::path& file);

}  // namespace simvis
