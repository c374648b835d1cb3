#include "import/mjcf/mjcf_heights.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "import/mesh/height_picture.h"
#include "scenegraph/shape_limits.h"

namespace simvis {
namespace {

struct Heights {
  std::uint32_t width = 0, height = 0;
  std::vector<double> values;
};

Heights inline_heights(const MjcfElement& asset) {
  const double rows = asset.number("nrow", 0), columns = asset.number("ncol", 0);
  for (const double side : {rows, columns}) {
    if (!(side >= 2 && side <= kMaxHeightsSide && side == std::floor(side))) {
      asset.fail("has no \"file\", and no nrow and ncol of at least 2 and at most " + std::to_string(kMaxHeightsSide));
    }
  }
  Heights heights{static_cast<std::uint32_t>(columns), static_cast<std::uint32_t>(rows), {}};
  const std::size_t count = std::size_t{heights.width} * heights.height;
  heights.values = asset.numbers("elevation", count, count);
  for (const double value : heights.values) {
    if (!(std::abs(value) <= kMaxShapeLength_m)) asset.fail("has an elevation that is not finite or beyond 10^6");
  }
  heights.values.resize(count, 0);  // MuJoCo's programs fill in what is not given
  return heights;
}

Heights heights_of_file(const std::filesystem::path& file) {
  const HeightPicture picture = read_height_picture(file);
  return {picture.width, picture.height, {picture.values.begin(), picture.values.end()}};
}

}  // namespace

HeightMap mjcf_height_map(const MjcfElement& asset) {
  const std::vector<double> size = asset.numbers("size", 4, 4);
  const auto is_length = [&](std::size_t i) { return size[i] >= kMinShapeLength_m && size[i] <= kMaxShapeLength_m; };
  if (size.empty() || !(is_length(0) && is_length(1) && size[2] > 0 && size[2] <= kMaxShapeLength_m)) {
    asset.fail(
        "has a size that is not above 0 or too large, expected two half edges, the height and the depth of the base");
  }
  const std::string file = asset.text("file");
  const Heights read = file.empty() ? inline_heights(asset)
                                    : heights_of_file(asset.model().asset_file(asset, asset.model().mesh_folder, file));
  const auto [low, high] = std::ranges::minmax(read.values);
  // Quotients by a power of two are exact, so that a height is rounded to float32 once.
  const double unit = high > low ? std::exp2(std::ilogb(high - low)) : 1, top = high > low ? (high - low) / unit : 1;
  HeightPicture heights{read.width, read.height, {}};
  heights.values.reserve(read.values.size());
  for (const double value : read.values) heights.values.push_back(static_cast<float>((value - low) / unit));
  return height_map(heights, {2 * size[0], 2 * size[1]}, 0, size[2] / top);
}

}  // namespace simvis
