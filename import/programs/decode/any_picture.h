// Reads pictures of every kind that a packaged library reads.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include <simvis/mesh.h>

namespace simvis {

/// Decodes what decode_with_stb() reads, PNM, TIFF and WebP. Of several pictures the first is read. May crash on broken
/// data. `subject` begins every message. Throws InputError with the reason, which names the kind of a picture that
/// cannot be read (DDS, KTX, OpenEXR).
Texture decode_any_picture(std::span<const std::uint8_t> bytes, const std::string& subject);

}  // namespace simvis
