// Decodes OpenEXR files as heights and as radiance.
#pragma once

#include <cstdint>
#include <span>

#include "scenegraph/picture_reader.h"

namespace simvis {

/// The channel Y, Z or R, the first of these that the file has. Throws std::exception with the reason, which begins
/// with a verb.
HeightPicture decode_exr_heights(std::span<const std::uint8_t> bytes);

/// The channels R, G and B, or else Y as a grey. Throws like decode_exr_heights().
SkyPicture decode_exr_sky(std::span<const std::uint8_t> bytes);

}  // namespace simvis
