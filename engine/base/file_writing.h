// Calls that every file of results is written with.
#pragma once

#include <filesystem>
#include <string_view>

#include "engine/base/program_api.h"

namespace simvis {

/// Throws MachineError: "PATH: error: WHAT: the reason for the number `error`".
[[noreturn]] SIMVIS_PROGRAM_API void throw_file_error(const std::filesystem::path& path, const char* what, int error);

/// Writes all bytes to the descriptor. Throws MachineError about `path`.
SIMVIS_PROGRAM_API void write_all(int descriptor, const std::filesystem::path& path, std::string_view bytes);

/// Opens a character device for writing. `named` leads to it; errors name it. Throws MachineError, also if something
/// else has taken the name in the meantime.
SIMVIS_PROGRAM_API int open_device(const std::filesystem::path& device, const std::filesystem::path& named);

/// Whether the name leads to the open file, without a symbolic link.
SIMVIS_PROGRAM_API bool leads_to(const std::filesystem::path& name, int descriptor);

/// Throws MachineError if a file that is being written was removed, renamed or replaced: what is written to it is lost.
SIMVIS_PROGRAM_API void require_own_name(const std::filesystem::path& name, int descriptor);

}  // namespace simvis
