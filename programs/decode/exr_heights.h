// Decodes OpenEXR files as heights.
#pragma once

#include <cstdint>
#include <span>

#include "scenegraph/picture_reader.h"

namespace simvis {

/// The channel Y, Z or R, the first of these that the file has. Throws std::exception with the reason, which begins
/// with a verb.
HeightPicture decode_exr_heights(std::span<const std::uint8_t> bytes);

}  // namespace simvis
