// What a program that reads part files takes away from itself.
#pragma once

#include <cstddef>

namespace simvis {

/// No more memory than `more_bytes` beyond what the process has now, no core file, and no life longer than that of the
/// thread that started it. AddressSanitizer maps terabytes for itself; memory is not limited then.
/// Throws MachineError.
void limit_process(std::size_t more_bytes);

}  // namespace simvis
