#include "import/mjcf/mjcf_heights.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "import/mesh/height_picture.h"
#include "scenegraph/shape_limits.h"

namespace simvis {
namespace {

HeightPicture inline_heights(const MjcfElement& asset) {
  const double rows = asset.number("nrow", 0), columns = asset.number("ncol", 0);
  for (const double side : {rows, columns}) {
    if (!(side >= 2 && side <= kMaxHeightsSide && side == std::floor(side))) {
      asset.fail("has no \"file\", and no nrow and ncol of at least 2 and at most " + std::to_string(kMaxHeightsSide));
    }
  }
  HeightPicture heights{static_cast<std::uint32_t>(columns), static_cast<std::uint32_t>(rows), {}};
  const std::size_t count = std::size_t{heights.width} * heights.height;
  const std::vector<double> values = asset.numbers("elevation", count, count);
  for (const double value : values) {
    if (!(std::abs(value) <= kMaxShapeLength_m)) asset.fail("has an elevation that is not finite or beyond 10^6");
  }
  heights.values.assign(values.begin(), values.end());
  heights.values.resize(count, 0);  // MuJoCo's programs fill in what is not given
  return heights;
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
  HeightPicture heights = file.empty() ? inline_heights(asset)
                                       : read_height_picture(asset.model().asset_file(asset.model().mesh_folder, file));
  const auto [low, high] = std::ranges::minmax(heights.values);
  for (float& value : heights.values) value = high > low ? (value - low) / (high - low) : 0;
  return height_map(heights, {2 * size[0], 2 * size[1]}, 0, size[2]);
}

}  // namespace simvis
