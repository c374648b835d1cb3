// The checksums of PNG, which stb_image does not compare.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace simvis {

/// Throws InputError if a chunk of a PNG that decoders need differs from its checksum. Other files pass, and so does a
/// chunk that is cut off, which decoders refuse. `subject` begins the message.
void check_png_chunks(std::span<const std::uint8_t> bytes, const std::string& subject);

}  // namespace simvis
