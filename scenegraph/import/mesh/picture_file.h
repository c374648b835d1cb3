// PNG and JPEG files as textures, whatever part file they belong to.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include <simvis/mesh.h>

namespace simvis {

/// Decodes a PNG or JPEG file that lies in memory to RGBA8; name and sampler stay at their defaults.
/// `subject` begins every message: "robot.glb: error: images/0".
/// Throws InputError: neither PNG nor JPEG, broken, more than 16384 pixels on a side.
Texture decode_picture(std::span<const std::uint8_t> bytes, const std::string& subject);

/// The same for a file on disk, which names itself in messages: "FILE: error: ...".
Texture read_picture_file(const std::filesystem::path& file);

}  // namespace simvis
