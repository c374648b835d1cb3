// Limits that an import program sets on its own process.
#pragma once

#include <cstddef>

#include "engine/base/read_fence.h"
#include "import/programs/system_calls.h"

namespace simvis {

/// Files that an import program may have open: a part that includes others has one open for each level.
inline constexpr unsigned kMaxOpenFiles = 256;

struct ProcessLimits {
  std::size_t memory_bytes = 0;  ///< beyond the present use
  Folders folders;               ///< whose files it may read; file_access.h
  HelperProgram program;         ///< whose system calls it may make; system_calls.h
};

/// Limits the memory, the number and size of open files, the files that can be opened and the system calls, forbids
/// core files, and ends the process when the thread that started it ends, or at once if the reader of its answer is
/// gone. Memory is not limited under AddressSanitizer, which maps terabytes for itself. The time of the processor is
/// limited by SimVis, which starts the process (sandbox_process.h). Throws MachineError if a limit cannot be set. A
/// kernel without a filter for system calls is a fault for xacro alone, which evaluates code of the file.
void limit_process(const ProcessLimits& limits);

}  // namespace simvis
