// Decodes pictures and meshes with libraries in a separate program, because they may crash or hang on broken data.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include <simvis/mesh.h>
#include "import/sandbox/draco_mesh.h"
#include "scenegraph/picture_reader.h"

namespace simvis {

struct DecodeLimits {
  std::chrono::milliseconds time{10'000};           ///< of the processor
  std::size_t memory_bytes = std::size_t{4} << 30;  ///< not enforced under AddressSanitizer
};

/// Decodes a picture of any kind that the program simvis-decode reads; see decode_picture(). `subject` begins every
/// message. Throws InputError if the picture is refused, the program crashes or gives a malformed answer;
/// MachineError if the program cannot be started or exceeds a limit, or the machine fails (helper_end.h).
Texture decode_picture_in_sandbox(std::span<const std::uint8_t> bytes, const std::string& subject,
                                  const DecodeLimits& limits = {});

/// Decodes an EXR as heights; see read_height_picture(). Its values may be any. Throws like
/// decode_picture_in_sandbox().
HeightPicture decode_heights_in_sandbox(std::span<const std::uint8_t> bytes, const std::string& subject,
                                        const DecodeLimits& limits = {});

/// Decodes an EXR or a Radiance HDR as a picture of the sky; see read_sky_picture(). Its values may be any. Throws like
/// decode_picture_in_sandbox().
SkyPicture decode_sky_in_sandbox(std::span<const std::uint8_t> bytes, const std::string& subject,
                                 const DecodeLimits& limits = {});

/// Decodes Draco data with the given attributes. Throws like decode_picture_in_sandbox().
DracoMesh decode_draco_in_sandbox(std::span<const std::uint8_t> bytes, std::span<const DracoAttribute> attributes,
                                  const std::string& subject, const DecodeLimits& limits = {});

}  // namespace simvis
