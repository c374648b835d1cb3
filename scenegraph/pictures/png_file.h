// Encodes linear colour as an 8-bit sRGB PNG or JPEG.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/base/program_api.h"
#include "scenegraph/image_span.h"

namespace simvis {

/// The codes of red, green and blue of each pixel, rows from the top. Alpha is dropped.
SIMVIS_PROGRAM_API std::vector<std::uint8_t> srgb_codes(const ImageSpan& color);

/// Returns the bytes of a PNG with three channels. Alpha is dropped, because camera images are opaque.
/// `color` has 4 channels and at least one pixel. Throws MachineError if memory runs out.
SIMVIS_PROGRAM_API std::string encode_png(const ImageSpan& color);

/// The quality of JPEG pictures, of 100. Above 90 the encoder keeps the full resolution of colour.
inline constexpr int kJpegQuality = 95;

/// As encode_png(), as a baseline JPEG.
SIMVIS_PROGRAM_API std::string encode_jpeg(const ImageSpan& color);

}  // namespace simvis
