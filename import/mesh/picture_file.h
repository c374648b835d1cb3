// Reads picture files as textures, for all part formats.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <simvis/mesh.h>

namespace simvis {

/// Below half a step of an 8-bit alpha channel no program shows a surface. Old exporters write opaque surfaces so.
inline constexpr double kWhollyTransparent = 0.5 / 255;

/// Decodes a picture file in memory to RGBA8: PNG, JPEG, TGA, BMP, PSD, GIF, HDR, PNM, TIFF, WebP. All but PNG and JPEG
/// are decoded by the program simvis-decode. Name and sampler keep their defaults.
/// `subject` begins every message, for example "robot.glb: error: images/0".
/// Throws InputError if the file is of another kind, is broken or has more than 16384 pixels on a side.
Texture decode_picture(std::span<const std::uint8_t> bytes, const std::string& subject);

/// Decodes a file on disk in the same way. Messages begin with "FILE: error: ".
Texture read_picture_file(const std::filesystem::path& file);

/// Finds and decodes the picture that `part_file` calls `name`; see picture_search.h. Returns nothing and adds one
/// warning if it is not there or cannot be decoded, because the material's colour then takes its place. Adds a warning
/// if it was found elsewhere. Does not throw InputError.
std::optional<Texture> find_and_read_picture(const std::string& name, const std::filesystem::path& part_file,
                                             std::vector<std::string>& warnings);

/// "a.dae: error: no meshes" -> "a.dae: no meshes", for use in a warning.
std::string without_word_error(std::string message);

}  // namespace simvis
