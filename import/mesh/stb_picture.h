// Reads pictures with stb_image.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include <simvis/mesh.h>

namespace simvis {

/// Decides by the first bytes.
bool is_png_or_jpeg(std::span<const std::uint8_t> bytes);

/// Decodes a picture file in memory to RGBA8: PNG, JPEG, and TGA, BMP, PSD, GIF and HDR, which stb_image reads
/// less carefully, so that only a helper program may pass them to this function. Of several pictures the first is read.
/// Name and sampler keep their defaults. `subject` begins every message. Throws InputError if the file is of another
/// kind, is broken or has more than 16384 pixels on a side.
Texture decode_with_stb(std::span<const std::uint8_t> bytes, const std::string& subject);

/// Throws why stb_image gave no picture in this thread: InputError with its reason, or std::bad_alloc.
[[noreturn]] void throw_stb_failure(const std::string& subject);

/// Throws InputError if the file has fewer bytes than so many pixels take at least, or a PNG differs from its
/// checksums.
void check_picture_bytes(std::span<const std::uint8_t> bytes, int width_px, int height_px, const std::string& subject);

/// Throws InputError if a side has no pixel or more than 16384 pixels.
void check_picture_size(std::int64_t width_px, std::int64_t height_px, const std::string& subject);

}  // namespace simvis
