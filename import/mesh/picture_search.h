// Finds the pictures that part files name, as Gazebo and mesh viewers find them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace simvis {

struct PictureSearch {
  std::optional<std::filesystem::path> file;  ///< empty: there is no such file
  bool elsewhere = false;                     ///< not where the part file says
  std::vector<std::string> tried;             ///< file names, in order

  /// "is not there; the material's colour replaces it; tried A, B"
  std::string not_found() const;
};

/// `name` is as the part file writes it; a backslash counts as a slash, and `file://` is left out. The search order:
///   1. relative to the folder of the part file, an absolute name as it is; then the same with percent-encoding decoded
///   2. the last component in `../materials/textures` beside the part file's folder, as in Gazebo
///   3. the last component in the part file's folder
///   4. all of these again, without regard to upper and lower case
/// The first two are where the field looks; a file that is found by the others is `elsewhere`. Files outside the fence
/// (read_fence.h) are not taken.
PictureSearch find_picture(const std::string& name, const std::filesystem::path& part_file);

}  // namespace simvis
