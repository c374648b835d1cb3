// Limits that an import program sets on its own process.
#pragma once

#include <cstddef>

namespace simvis {

/// Limits the memory to `more_bytes` beyond the present use, the number of open files and the system calls
/// (system_calls.h), forbids core files, and ends the process when the thread that started it ends. Memory is not
/// limited under AddressSanitizer, which maps terabytes for itself. Throws MachineError if a limit cannot be set.
void limit_process(std::size_t more_bytes);

}  // namespace simvis
