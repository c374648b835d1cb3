// Decodes pictures of the sky: OpenEXR and Radiance HDR.
#pragma once

#include <cstdint>
#include <span>

#include <simvis/sky_picture.h>

namespace simvis {

/// Decides by the first bytes. May crash on broken data. Throws std::exception with the reason, which begins with a
/// verb.
SkyPicture decode_sky_radiance(std::span<const std::uint8_t> bytes);

}  // namespace simvis
