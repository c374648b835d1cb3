#include "engine/base/srgb.h"

#include <array>
#include <bit>

#include "engine/base/assert.h"

namespace simvis {
namespace {

/// Table of codes by the upper bits of a float: eight bits of mantissa in each octave from 2^-13 to 1. Within one
/// bucket the code changes at most once, because it grows by less than 112 per factor of e and a bucket spans 1/256. So
/// the code at the start of the bucket and one comparison give the exact code.
struct SrgbTable {
  static constexpr std::uint32_t kFirst = 0x39000000u >> 15, kEnd = 0x3f800000u >> 15;  // 2^-13 and 1
  std::array<double, 257> start{};  // the smallest linear value of each code
  std::array<std::uint8_t, kEnd - kFirst> code{};

  SrgbTable() {
    for (int c = 1; c < 256; ++c) {
      const double s = (c - 0.5) / 255;
      start[static_cast<std::size_t>(c)] = decode_srgb(s);
    }
    start[256] = 2;
    int c = 0;
    for (std::uint32_t bucket = kFirst; bucket < kEnd; ++bucket) {
      const double low = std::bit_cast<float>(bucket << 15);
      while (low >= start[static_cast<std::size_t>(c) + 1]) ++c;
      code[bucket - kFirst] = static_cast<std::uint8_t>(c);
    }
  }
};

const SrgbTable kSrgb;

}  // namespace

std::uint8_t srgb_code(float linear) {
  if (!(linear >= 0x1p-13f)) return 0;  // the first code starts at 1 / 510 / 12.92 = 1.5e-4, above 2^-13
  if (linear >= 1.0f) return 255;
  const std::uint8_t code = kSrgb.code[(std::bit_cast<std::uint32_t>(linear) >> 15) - SrgbTable::kFirst];
  return static_cast<std::uint8_t>(code + (linear >= kSrgb.start[code + 1u] ? 1 : 0));
}

void srgb_codes(std::span<const float> rgba, std::span<std::uint8_t> rgb) {
  SIMVIS_ASSERT(rgba.size() / 4 * 3 == rgb.size());
  for (std::size_t i = 0; i < rgba.size() / 4; ++i) {
    for (std::size_t c = 0; c < 3; ++c) rgb[3 * i + c] = srgb_code(rgba[4 * i + c]);
  }
}

}  // namespace simvis
