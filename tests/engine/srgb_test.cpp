// The codes of sRGB against the definition, one by one and those of many pixels.
#include "engine/base/srgb.h"

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/support/infinity.h"
#include "tests/support/long_count.h"

TEST_SUITE_BEGIN("engine");

namespace simvis {
namespace {

int srgb_by_definition(double linear) {
  if (!(linear > 0)) return 0;
  if (linear >= 1) return 255;
  const double s = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
  return static_cast<int>(std::lround(255 * s));
}

TEST_CASE("sRGB codes are the rounded transfer function for every float") {
  // Every 37th float from 0 to 1 and both sides of every step: a prime, so that all low bits occur.
  std::uint64_t wrong = 0;
  for (std::uint32_t bits = 0; bits <= std::bit_cast<std::uint32_t>(1.0f); bits += 37) {
    const float value = std::bit_cast<float>(bits);
    wrong += srgb_code(value) != srgb_by_definition(value);
  }
  CHECK(wrong == 0);
  for (int code = 1; code < 256; ++code) {
    const double s = (code - 0.5) / 255;
    const double step = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
    // A float apart from the step is enough: 10^-7 relative against 10^-16 of the two formulas.
    const float at = static_cast<float>(step);
    CHECK(srgb_code(std::nextafter(at, 0.0f)) == code - 1);
    CHECK(srgb_code(std::nextafter(at, 1.0f)) == code);
  }
  CHECK(srgb_code(-1) == 0);
  CHECK(srgb_code(-kInfinity) == 0);
  CHECK(srgb_code(std::nanf("")) == 0);
  CHECK(srgb_code(7) == 255);
  CHECK(srgb_code(kInfinity) == 255);
}

// Floats of all kinds, NaN and infinity among them. The step is odd, so that 2^32 steps reach every float once.
// SIMVIS_TEST_IMAGES=350000 reaches all of them. On machines without AVX2 both sides are the same function, so that
// only the places of the codes are tested there.
TEST_CASE("codes of many pixels are those of their numbers") {
  constexpr std::size_t kPixels = 1 << 12;
  constexpr std::uint32_t kStep = 2654435761;
  const int images = count_of("SIMVIS_TEST_IMAGES", 300);
  std::vector<float> rgba(4 * kPixels);
  std::vector<std::uint8_t> rgb(3 * kPixels);
  std::uint64_t wrong = 0;
  std::uint32_t bits = 0;
  for (int image = 0; image < images; ++image) {
    for (std::size_t i = 0; i < kPixels; ++i) {
      for (std::size_t c = 0; c < 3; ++c, bits += kStep) rgba[4 * i + c] = std::bit_cast<float>(bits);
      rgba[4 * i + 3] = std::bit_cast<float>(~bits);
    }
    srgb_codes(rgba, rgb);
    for (std::size_t i = 0; i < rgb.size(); ++i) wrong += rgb[i] != srgb_code(rgba[i / 3 * 4 + i % 3]);
  }
  CHECK(wrong == 0);
  CHECK(bits == static_cast<std::uint32_t>(images * rgb.size()) * kStep);
}

TEST_CASE("codes of few pixels stay within their memory") {
  constexpr std::size_t kMost = 40, kGuard = 32;
  for (std::size_t pixels = 0; pixels <= kMost; ++pixels) {
    std::vector<float> rgba;
    for (std::size_t i = 0; i < 4 * pixels; ++i) rgba.push_back(static_cast<float>(i) / (4 * kMost));
    std::vector<std::uint8_t> rgb(3 * pixels + kGuard, 77);
    srgb_codes(rgba, std::span(rgb).first(3 * pixels));
    for (std::size_t i = 0; i < 3 * pixels; ++i) CHECK(rgb[i] == srgb_code(rgba[i / 3 * 4 + i % 3]));
    for (std::size_t i = 3 * pixels; i < rgb.size(); ++i) CHECK(rgb[i] == 77);
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
