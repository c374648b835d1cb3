// A view of an image whose numbers another object owns, so that readers of images need no copy.
#pragma once

#include <cstdint>
#include <span>

#include <simvis/image.h>

namespace simvis {

/// Shape and units as Image. Valid as long as the memory of the numbers.
struct ImageSpan {
  ImageSpan() = default;
  ImageSpan(const Image& image)  // NOLINT(google-explicit-constructor): as std::span from a vector
      : ImageSpan(image.width, image.height, image.channels, image.pixels) {}
  ImageSpan(std::uint32_t width_px, std::uint32_t height_px, std::uint32_t channel_count,
            std::span<const float> numbers)
      : width(width_px), height(height_px), channels(channel_count), pixels(numbers) {}

  std::uint32_t width = 0, height = 0, channels = 0;
  std::span<const float> pixels;
};

}  // namespace simvis
