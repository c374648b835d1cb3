// The Gaussian splats of a file as columns of numbers in memory, and the scene that they make.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <vector>

#include "engine/draw/splat_cloud.h"
#include "import/programs/clouds/point_columns.h"
#include "import/sandbox/imported_scene.h"

namespace simvis {

/// What a file says of its splats, as the program of Kerbl et al. 2023 trains and writes them.
struct SplatColumns {
  std::filesystem::path file;
  std::size_t count = 0;
  std::array<PointColumn, 3> center{};
  std::array<PointColumn, 3> log_sigma{};  ///< natural logarithms of the standard deviations
  std::array<PointColumn, 4> rotation{};   ///< w, x, y, z of a quaternion of any length
  PointColumn opacity{};                   ///< its logit
  /// Red, green and blue of the harmonic of degree 0, then all others of red, of green, and of blue.
  std::vector<PointColumn> harmonics{};
};

/// A scene of one mesh of splats. Splats with numbers that are not finite, without a rotation or without an extent are
/// left out, with a warning. Throws InputError for files without splats, with more than kMaxSplats, and with harmonics
/// that do not fill their degrees.
ImportedScene splat_scene(const SplatColumns& columns);

/// A scene of one mesh of these splats, and a warning if some were left out. Throws InputError if there is none.
ImportedScene splat_scene(const std::filesystem::path& file, std::shared_ptr<const SplatCloud> cloud,
                          std::size_t left_out);

/// As splat_scene() throws: for counts that readers know before they read the splats.
void check_splat_count(const std::filesystem::path& file, std::size_t count);

}  // namespace simvis
