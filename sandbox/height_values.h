// A picture of heights as simvis-decode answers it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scenegraph/picture_reader.h"

namespace simvis {

std::vector<std::uint8_t> pack_heights(const HeightPicture& picture);

/// Returns false if the bytes, which are not trusted, are no such answer. The values may be any.
bool unpack_heights(std::span<const std::uint8_t> bytes, HeightPicture& picture);

}  // namespace simvis
