// Encodes colour and depth in full precision as OpenEXR images.
#pragma once

#include <string>

#include <simvis/image.h>

namespace simvis {

/// Returns the bytes of a ZIP-compressed scanline EXR file with float32 channels: linear R, G and B if `color` is
/// given, Z (depth along Z in metres) if `depth` is given. At least one is not null; both have the same size. Throws
/// MachineError with the reason from OpenEXR.
std::string encode_exr(const Image* color, const Image* depth);

/// As encode_exr(), with one float32 channel named `channel`.
std::string encode_exr_plane(const std::string& channel, const Image& plane);

}  // namespace simvis
