// Conversion of sRGB-encoded colour values to linear light and back.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>

#include "engine/base/program_api.h"

namespace simvis {

/// The linear value of an sRGB-encoded value in [0, 1] (IEC 61966-2-1). The curve continues above 1.
inline double decode_srgb(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

/// The same, rounded once to float32.
inline float linear_from_srgb(double encoded) { return static_cast<float>(decode_srgb(encoded)); }

/// The sRGB code of a linear value: round(255 * sRGB transfer function), exact for every float. NaN and values below 0
/// give 0; values above 1 give 255.
std::uint8_t srgb_code(float linear);

/// The codes of red, green and blue of each pixel of four numbers. `rgb` has three of four as many numbers.
SIMVIS_PROGRAM_API void srgb_codes(std::span<const float> rgba, std::span<std::uint8_t> rgb);

}  // namespace simvis
