#include "simvis/output/depth_png_file.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include "engine/base/assert.h"
#include "scenegraph/pictures/png_bytes.h"

namespace simvis {

namespace {

/// The codes of all rows, the high byte first.
std::vector<std::uint8_t> codes_of(const Image& depth, double unit_m) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(2 * depth.pixels.size());
  for (const float depth_m : depth.pixels) {
    const std::uint16_t code = depth_code(depth_m, unit_m);
    bytes.push_back(static_cast<std::uint8_t>(code >> 8));
    bytes.push_back(static_cast<std::uint8_t>(code & 0xff));
  }
  return bytes;
}

}  // namespace

std::uint16_t depth_code(float depth_m, double unit_m) {
  const double code = std::round(static_cast<double>(depth_m) / unit_m);
  return code >= 0 && code <= 0xffff ? static_cast<std::uint16_t>(code) : 0;
}

std::string encode_depth_png(const Image& depth, double unit_m) {
  SIMVIS_ASSERT(depth.channels == 1 && unit_m > 0);
  SIMVIS_ASSERT(depth.pixels.size() == std::size_t{depth.width} * depth.height);
  return png_bytes({.width = depth.width, .height = depth.height, .bits = 16, .channels = 1, .filter = PngFilter::up},
                   codes_of(depth, unit_m));
}

}  // namespace simvis
