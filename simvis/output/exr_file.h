// Colour and depth in full precision as an OpenEXR picture.
#pragma once

#include <string>

#include <simvis/image.h>

namespace simvis {

/// The bytes of a scanline EXR, ZIP compressed, with float32 channels: R, G and B (linear) when there is `color`, Z
/// (metres along the optical axis) when there is `depth`. At least one is given; both are of one size.
/// Throws MachineError with OpenEXR's reason.
std::string encode_exr(const Image* color, const Image* depth);

/// The same with one float32 channel of this name.
std::string encode_exr_plane(const std::string& channel, const Image& plane);

}  // namespace simvis
