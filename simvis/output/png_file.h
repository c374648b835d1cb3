// Linear colour as an 8-bit sRGB PNG.
#pragma once

#include <cstdint>
#include <string>

#include <simvis/image.h>

namespace simvis {

/// The sRGB code of a linear value: round(255 * sRGB transfer function), exact for every float. What is below 0 and
/// NaN become 0, what is above 1 becomes 255.
std::uint8_t srgb_code(float linear);

/// The bytes of a PNG with three channels; alpha is left out, as cameras see opaque pictures.
/// `color` has 4 channels and at least one pixel. Throws MachineError when memory runs out.
std::string encode_png(const Image& color);

}  // namespace simvis
