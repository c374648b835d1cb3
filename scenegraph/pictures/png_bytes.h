// The bytes of a PNG: rows, filters, compression and chunks.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "engine/base/program_api.h"

namespace simvis {

/// The filters of PNG that are used: the difference of a byte to the one above, or to Paeth's prediction from the
/// bytes to the left, above, and above left.
enum class PngFilter : std::uint8_t { up = 2, paeth = 4 };

struct PngLayout {
  std::uint32_t width = 0, height = 0;
  std::uint8_t bits = 8;      ///< of a number
  std::uint8_t channels = 3;  ///< 4: RGB and alpha, 3: RGB, 1: grey
  PngFilter filter = PngFilter::paeth;

  std::size_t pixel_bytes() const { return std::size_t{channels} * bits / 8; }
  std::size_t row_bytes() const { return width * pixel_bytes(); }
};

/// `rows` holds height * row_bytes() bytes from the top, numbers of 16 bits with the high byte first. Throws
/// MachineError if memory runs out.
SIMVIS_PROGRAM_API std::string png_bytes(const PngLayout& layout, std::span<const std::uint8_t> rows);

}  // namespace simvis
