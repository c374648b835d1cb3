// Colours as screens show them, and the light that they stand for.
#pragma once

#include <cmath>

namespace simvis {

/// The linear value of an sRGB-encoded one, 0 to 1 (IEC 61966-2-1); above 1 the curve goes on.
inline double decode_srgb(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

/// The same, rounded once.
inline float linear_from_srgb(double encoded) { return static_cast<float>(decode_srgb(encoded)); }

}  // namespace simvis
