// Limits that an import program sets on its own process.
#pragma once

#include <cstddef>

#include "engine/base/read_fence.h"

namespace simvis {

/// Files that an import program may have open: a part that includes others has one open for each level.
inline constexpr unsigned kMaxOpenFiles = 256;

struct ProcessLimits {
  std::size_t memory_bytes = 0;  ///< beyond the present use
  Folders folders;               ///< whose files it may read; file_access.h
};

/// Limits the memory, the number and size of open files, the files that can be opened and the system calls
/// (system_calls.h), forbids core files, and ends the process when the thread that started it ends. Memory is not
/// limited under AddressSanitizer, which maps terabytes for itself. The time of the processor is limited by SimVis,
/// which starts the process (sandbox_process.h). Throws MachineError if a limit cannot be set.
void limit_process(const ProcessLimits& limits);

}  // namespace simvis
