// Memory for the moment in which there is none.
#pragma once

namespace simvis {

/// Sets memory aside, once for the program. When an allocation of C++ fails, it gets this memory instead, so that what
/// cannot fail, such as a destructor, does not; the run then ends at its next require_memory(). Allocations that fail
/// after that, or are larger, throw std::bad_alloc.
void set_memory_aside();

/// Throws MachineError if the memory that was set aside has been needed.
void require_memory();

}  // namespace simvis
