#include "scenegraph/pictures/stb_pictures.h"

#include <zlib.h>

#include <cstdlib>

#include <simvis/error.h>
#include "engine/base/assert.h"

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

// Filter "up": the best for smooth images at this speed, without a search for each row.
[[maybe_unused]] const int kRowFilter = stbi_write_force_png_filter = 2;

void append_chunk(void* bytes, void* data, int size) {
  static_cast<std::string*>(bytes)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
}

}  // namespace

std::string png_of_rgb(std::span<const std::uint8_t> rgb, int width, int height) {
  SIMVIS_ASSERT(rgb.size() == std::size_t{3} * static_cast<unsigned>(width) * static_cast<unsigned>(height));
  int size = 0;
  unsigned char* const bytes = stbi_write_png_to_mem(rgb.data(), 3 * width, width, height, 3, &size);
  if (bytes == nullptr) throw MachineError("out of memory while a PNG was compressed");
  std::string png(reinterpret_cast<const char*>(bytes), static_cast<std::size_t>(size));
  std::free(bytes);
  return png;
}

std::string jpeg_of_rgb(std::span<const std::uint8_t> rgb, int width, int height, int quality) {
  SIMVIS_ASSERT(rgb.size() == std::size_t{3} * static_cast<unsigned>(width) * static_cast<unsigned>(height));
  std::string jpeg;
  if (stbi_write_jpg_to_func(append_chunk, &jpeg, width, height, 3, rgb.data(), quality) == 0) {
    throw MachineError("a JPEG picture of " + std::to_string(width) + " x " + std::to_string(height) +
                       " pixels cannot be encoded");
  }
  return jpeg;
}

}  // namespace simvis
