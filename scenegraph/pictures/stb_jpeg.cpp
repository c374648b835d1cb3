#include "scenegraph/pictures/stb_jpeg.h"

#include <simvis/error.h>
#include "engine/base/assert.h"

#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb_image_write.h>
#pragma GCC diagnostic pop

namespace simvis {

namespace {

void append_chunk(void* bytes, void* data, int size) {
  static_cast<std::string*>(bytes)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
}

}  // namespace

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
