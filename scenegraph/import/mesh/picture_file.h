// Reads PNG and JPEG files as textures, for all part formats.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include <simvis/mesh.h>

namespace simvis {

/// Decodes a PNG or JPEG file in memory to RGBA8. Name and sampler keep their defaults.
/// `subject` begins every message, for example "robot.glb: error: images/0".
/// Throws InputError if the file is neither PNG nor JPEG, is broken or has more than 16384 pixels on a side.
Texture decode_picture(std::span<const std::uint8_t> bytes, const std::string& subject);

/// Decodes a file on disk in the same way. Messages begin with "FILE: error: ".
Texture read_picture_file(const std::filesystem::path& file);

}  // namespace simvis
