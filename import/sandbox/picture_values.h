// Pictures of heights and of the sky as simvis-decode answers them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scenegraph/picture_reader.h"

namespace simvis {

std::vector<std::uint8_t> pack_heights(const HeightPicture& picture);
std::vector<std::uint8_t> pack_sky(const SkyPicture& picture);

/// Both return false if the bytes, which are not trusted, are no such answer. The values may be any.
bool unpack_heights(std::span<const std::uint8_t> bytes, HeightPicture& picture);
bool unpack_sky(std::span<const std::uint8_t> bytes, SkyPicture& picture);

}  // namespace simvis
