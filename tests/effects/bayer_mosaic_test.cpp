// The Bayer mosaic: which colours are kept, and what interpolation makes of the others.
#include "effects/camera/bayer_mosaic.h"

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

TEST_SUITE_BEGIN("effects");

namespace simvis {
namespace {

// Colours that change linearly over the image, each in its own way.
double ramp(std::uint32_t x, std::uint32_t y, int channel) {
  return 0.2 + 0.1 * channel + (0.03 - 0.02 * channel) * x + 0.01 * (channel - 0.5) * y;
}

Image ramps(std::uint32_t width, std::uint32_t height) {
  std::vector<float> pixels;
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      for (int c = 0; c < 3; ++c) pixels.push_back(static_cast<float>(ramp(x, y, c)));
      pixels.push_back(1);
    }
  }
  return {width, height, 4, std::move(pixels)};
}

constexpr BayerPattern kPatterns[] = {{0, 1, 1, 2}, {2, 1, 1, 0}, {1, 0, 2, 1}, {1, 2, 0, 1}};

TEST_CASE("a raw mosaic has the colour of its pixel in all channels") {
  for (const BayerPattern& pattern : kPatterns) {
    Image image = ramps(7, 6);
    BayerMosaic(pattern, false).post_process({}, {}, image);
    for (std::uint32_t y = 0; y < 6; ++y) {
      for (std::uint32_t x = 0; x < 7; ++x) {
        const float* const pixel = &image.pixels[4 * (std::size_t{7} * y + x)];
        const auto own = static_cast<float>(ramp(x, y, pattern[2 * (y % 2) + x % 2]));
        for (int c = 0; c < 3; ++c) CHECK(pixel[c] == own);
        CHECK(pixel[3] == 1);
      }
    }
  }
}

TEST_CASE("bilinear interpolation gives colours that change linearly as they were, and keeps what was measured") {
  // Up to four float32 numbers below 1 are added in double, and the mean is rounded once.
  constexpr double kRounding = 2 * 0x1p-24;
  for (const BayerPattern& pattern : kPatterns) {
    Image image = ramps(9, 8);
    BayerMosaic(pattern, true).post_process({}, {}, image);
    for (std::uint32_t y = 0; y < 8; ++y) {
      for (std::uint32_t x = 0; x < 9; ++x) {
        const bool border = x == 0 || y == 0 || x == 8 || y == 7;
        for (std::uint8_t c = 0; c < 3; ++c) {
          const float value = image.pixels[4 * (std::size_t{9} * y + x) + c];
          if (pattern[2 * (y % 2) + x % 2] == c) CHECK(value == static_cast<float>(ramp(x, y, c)));
          // At the border some neighbours are missing: the mean is that of a point at most one pixel away.
          CHECK(std::abs(value - ramp(x, y, c)) < kRounding + (border ? 0.06 : 0));
        }
      }
    }
  }
}

TEST_CASE("the smallest images have a mosaic too") {
  for (const BayerPattern& pattern : kPatterns) {
    for (const auto& [width, height] : {std::pair(1u, 1u), std::pair(1u, 5u), std::pair(4u, 1u), std::pair(2u, 2u)}) {
      Image image = ramps(width, height);
      BayerMosaic(pattern, true).post_process({}, {}, image);
      for (const float value : image.pixels) CHECK(std::isfinite(value));
    }
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
