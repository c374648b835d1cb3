// Reads points from a text file.
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

/// The largest number of points in a file.
inline constexpr std::size_t kMaxPoints = 1'000'000;

/// Each line holds one point: "x y z" or "x y z r g b", separated by spaces, commas or both. Coordinates are in metres,
/// and colours are sRGB from 0 to 255 as in pictures. Either every line has a colour or none has. Empty lines and lines
/// that start with '#' are skipped, and also a first line "x,y,z" or "x,y,z,r,g,b".
/// Throws InputError with FILE:LINE:COLUMN for a line that is not a point, a coordinate beyond kMaxCoordinate_m, no
/// points at all, too many points, text that is not UTF-8, or a file that cannot be read.
PointFile read_point_file(const std::filesystem::path& file);

}  // namespace simvis
