#include "program/datasets/pixel_mask.h"

#include "scenegraph/pictures/png_bytes.h"

namespace simvis {
namespace {

std::vector<std::int64_t> runs_of(const PixelMask& mask) {
  std::vector<std::int64_t> runs{0};
  std::uint8_t last = 0;
  for (std::size_t x = 0; x < mask.width_px; ++x) {
    for (std::size_t y = 0; y < mask.height_px; ++y) {
      const std::uint8_t pixel = mask.pixels[y * mask.width_px + x];
      if (pixel != last) runs.push_back(0);
      ++runs.back();
      last = pixel;
    }
  }
  return runs;
}

void append_number(std::int64_t number, std::string& text) {
  for (bool more = true; more;) {
    auto bits = static_cast<int>(number & 0x1f);
    number >>= 5;
    more = (bits & 0x10) != 0 ? number != -1 : number != 0;
    if (more) bits |= 0x20;
    text += static_cast<char>(bits + '0');
  }
}

}  // namespace

PixelMask mask_of(const MeasuredArray& ids, std::uint32_t id) {
  PixelMask mask{ids.shape.columns, ids.shape.rows, {}};
  mask.pixels.reserve(ids.count());
  const auto wanted = static_cast<double>(id);
  for (std::size_t i = 0; i < ids.count(); ++i) mask.pixels.push_back(ids.number(i) == wanted ? 1 : 0);
  return mask;
}

PixelMask mask_channel(const MeasuredArray& image, std::uint32_t channel) {
  PixelMask mask{image.shape.columns, image.shape.rows, {}};
  const std::size_t pixels = std::size_t{mask.width_px} * mask.height_px;
  mask.pixels.reserve(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    mask.pixels.push_back(image.number(i * image.shape.channels + channel) != 0 ? 1 : 0);
  }
  return mask;
}

std::string mask_png(const PixelMask& mask) {
  std::vector<std::uint8_t> codes;
  codes.reserve(mask.pixels.size());
  for (const std::uint8_t pixel : mask.pixels) codes.push_back(pixel != 0 ? 255 : 0);
  return png_bytes(
      {.width = mask.width_px, .height = mask.height_px, .bits = 8, .channels = 1, .filter = PngFilter::up}, codes);
}

std::string coco_rle(const PixelMask& mask) {
  const std::vector<std::int64_t> runs = runs_of(mask);
  std::string text;
  for (std::size_t i = 0; i < runs.size(); ++i) append_number(i > 2 ? runs[i] - runs[i - 2] : runs[i], text);
  return text;
}

}  // namespace simvis
