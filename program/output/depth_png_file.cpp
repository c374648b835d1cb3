#include "program/output/depth_png_file.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <variant>
#include <vector>

#include "engine/base/assert.h"
#include "program/output/formats.h"
#include "scenegraph/pictures/png_bytes.h"

namespace simvis {

namespace {

/// The PNG of a code for each number, the high byte first.
template <typename Numbers, typename CodeOf>
std::string grey_png(std::uint32_t width, std::uint32_t height, const Numbers& numbers, const CodeOf& code_of) {
  SIMVIS_ASSERT(numbers.size() == std::size_t{width} * height);
  std::vector<std::uint8_t> bytes;
  bytes.reserve(2 * numbers.size());
  for (const auto number : numbers) {
    const std::uint16_t code = code_of(number);
    bytes.push_back(static_cast<std::uint8_t>(code >> 8));
    bytes.push_back(static_cast<std::uint8_t>(code & 0xff));
  }
  return png_bytes({.width = width, .height = height, .bits = 16, .channels = 1, .filter = PngFilter::up}, bytes);
}

}  // namespace

std::uint16_t depth_code(float depth_m, double unit_m) {
  const double code = std::round(static_cast<double>(depth_m) / unit_m);
  return code >= 0 && code <= 0xffff ? static_cast<std::uint16_t>(code) : 0;
}

std::string encode_depth_png(const Image& depth, double unit_m) {
  SIMVIS_ASSERT(depth.channels == 1 && unit_m > 0);
  return grey_png(depth.width, depth.height, depth.pixels, [&](float depth_m) { return depth_code(depth_m, unit_m); });
}

std::string encode_counts_png(const MeasuredArray& counts) {
  return grey_png(counts.shape.columns, counts.shape.rows, std::get<SharedArray<std::uint32_t>>(counts.numbers),
                  [](std::uint32_t count) { return static_cast<std::uint16_t>(std::min(count, 0xffffu)); });
}

namespace {

const FormatRegistration kDepthPngFormat(
    {.kind = "depth",
     .name = "png",
     .file = "CAMERA_depth/000000.png",
     .text = "16-bit codes of `--depth-unit`, 0 where nothing is hit or the code would exceed 65535",
     .order = 10,
     .encode_depth = encode_depth_png});

}  // namespace

}  // namespace simvis
