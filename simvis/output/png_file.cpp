#include "simvis/output/png_file.h"

#include <zlib.h>

#include <array>
#include <bit>
#include <cstdlib>
#include <vector>

#include <simvis/error.h>
#include "engine/base/assert.h"
#include "engine/base/srgb.h"

namespace {

// The compressor of stb takes several times as long as the fastest level of zlib and gives a larger file.
unsigned char* compress_fast(unsigned char* data, int size, int* compressed_size, int /*quality*/) {
  uLongf length = compressBound(static_cast<uLong>(size));
  auto* const out = static_cast<unsigned char*>(std::malloc(length));
  if (out == nullptr) return nullptr;
  if (compress2(out, &length, data, static_cast<uLong>(size), Z_BEST_SPEED) != Z_OK) {
    std::free(out);
    return nullptr;
  }
  *compressed_size = static_cast<int>(length);
  return out;
}

}  // namespace

#define STBIW_ZLIB_COMPRESS compress_fast
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb_image_write.h>
#pragma GCC diagnostic pop

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

// Filter "up": the best for smooth images at this speed, without a search for each row.
[[maybe_unused]] const int kRowFilter = stbi_write_force_png_filter = 2;

}  // namespace

std::uint8_t srgb_code(float linear) {
  if (!(linear >= 0x1p-13f)) return 0;  // the first code starts at 1 / 510 / 12.92 = 1.5e-4, above 2^-13
  if (linear >= 1.0f) return 255;
  const std::uint8_t code = kSrgb.code[(std::bit_cast<std::uint32_t>(linear) >> 15) - SrgbTable::kFirst];
  return static_cast<std::uint8_t>(code + (linear >= kSrgb.start[code + 1u] ? 1 : 0));
}

std::string encode_png(const Image& color) {
  SIMVIS_ASSERT(color.channels == 4 && color.width > 0 && color.height > 0);
  const std::size_t pixels = std::size_t{color.width} * color.height;
  SIMVIS_ASSERT(color.pixels.size() == 4 * pixels);
  std::vector<std::uint8_t> rgb(3 * pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    for (std::size_t c = 0; c < 3; ++c) rgb[3 * i + c] = srgb_code(color.pixels[4 * i + c]);
  }
  int size = 0;
  const int width = static_cast<int>(color.width), height = static_cast<int>(color.height);
  unsigned char* const bytes = stbi_write_png_to_mem(rgb.data(), 3 * width, width, height, 3, &size);
  if (bytes == nullptr) throw MachineError("out of memory while a PNG was compressed");
  std::string png(reinterpret_cast<const char*>(bytes), static_cast<std::size_t>(size));
  std::free(bytes);
  return png;
}

}  // namespace simvis
