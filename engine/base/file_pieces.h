// A file that is read from its beginning to its end.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>

#include "engine/base/program_api.h"

namespace simvis {

/// Calls `use` with the bytes of a regular file, a MiB at a time at most, and with no more bytes than the file had when
/// it was opened: a device, a FIFO and a file of /proc may have no end. Throws as InputFile.
SIMVIS_PROGRAM_API void read_in_pieces(const std::filesystem::path& file,
                                       const std::function<void(std::span<const std::uint8_t>)>& use);

}  // namespace simvis
