#include "scenegraph/pictures/png_file.h"

#include <vector>

#include "engine/base/assert.h"
#include "engine/base/srgb.h"
#include "scenegraph/pictures/png_bytes.h"
#include "scenegraph/pictures/stb_jpeg.h"

namespace simvis {

std::vector<std::uint8_t> srgb_codes(const ImageSpan& color) {
  SIMVIS_ASSERT(color.channels == 4 && color.width > 0 && color.height > 0);
  const std::size_t pixels = std::size_t{color.width} * color.height;
  SIMVIS_ASSERT(color.pixels.size() == 4 * pixels);
  std::vector<std::uint8_t> rgb(3 * pixels);
  srgb_codes(color.pixels, rgb);
  return rgb;
}

std::string encode_png(const ImageSpan& color) {
  return png_bytes({.width = color.width, .height = color.height}, srgb_codes(color));
}

std::string encode_jpeg(const ImageSpan& color) {
  return jpeg_of_rgb(srgb_codes(color), static_cast<int>(color.width), static_cast<int>(color.height), kJpegQuality);
}

}  // namespace simvis
