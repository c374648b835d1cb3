// JPEG pictures of 8-bit RGB by stb_image_write, the only place that includes it.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace simvis {

/// A baseline JPEG; `quality` from 1 to 100. `rgb` holds width * height * 3 codes, rows from the top. Throws
/// MachineError if memory runs out.
std::string jpeg_of_rgb(std::span<const std::uint8_t> rgb, int width, int height, int quality);

}  // namespace simvis
