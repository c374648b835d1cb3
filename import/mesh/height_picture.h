// Reads pictures of heights: PNG, with 8 or 16 bits, and OpenEXR.
#pragma once

#include <filesystem>

#include "scenegraph/picture_reader.h"

namespace simvis {

/// The grey of a PNG from 0 to 1, without gamma and without rounding; of an EXR, which simvis-decode decodes, the
/// channel Y, Z or R, the first of these that it has. Throws InputError "FILE: error: ..." for files of another kind,
/// broken ones, fewer than 2 or more than kMaxHeightsSide pixels on a side, and values that are not finite or beyond
/// 10^6.
HeightPicture read_height_picture(const std::filesystem::path& file);

}  // namespace simvis
