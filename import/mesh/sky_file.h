// Reads pictures of the sky: OpenEXR and Radiance HDR.
#pragma once

#include <filesystem>

#include <simvis/sky_picture.h>

namespace simvis {

/// The program simvis-decode decodes the file. An EXR has the channels R, G and B, or Y.
/// Throws InputError "FILE: error: ..." for files of another kind, broken ones, pictures that are not twice as wide as
/// high or wider than kMaxSkyWidth_px, and values that are negative, not finite or above 10^12.
SkyPicture read_sky_picture(const std::filesystem::path& file);

}  // namespace simvis
