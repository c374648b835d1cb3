// Conversion of sRGB-encoded colour values to linear light.
#pragma once

#include <cmath>

namespace simvis {

/// The linear value of an sRGB-encoded value in [0, 1] (IEC 61966-2-1). The curve continues above 1.
inline double decode_srgb(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

/// The same, rounded once to float32.
inline float linear_from_srgb(double encoded) { return static_cast<float>(decode_srgb(encoded)); }

}  // namespace simvis
