// Pictures of Netpbm: PGM and PPM, in bytes and in text.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include <simvis/mesh.h>

namespace simvis {

/// Returns whether the first bytes are those of P2, P3, P5 or P6.
bool is_pnm(std::span<const std::uint8_t> bytes);

/// Decodes such a file (Netpbm, pgm(5) and ppm(5)) to RGBA8. Any largest value from 1 to 65535 becomes 255; a larger
/// number counts as the largest value. `subject` begins every message. Throws InputError if the file is broken or has
/// more than 16384 pixels on a side.
Texture decode_pnm(std::span<const std::uint8_t> bytes, const std::string& subject);

}  // namespace simvis
