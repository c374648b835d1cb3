#include "import/programs/failed_allocations.h"

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <vector>

#include "import/sandbox/import_answer.h"

namespace simvis {
namespace {

// Made while there is memory.
std::vector<std::uint8_t> allocation_report;
int allocation_descriptor = -1;
std::atomic<bool> is_armed{false};

// Runs within malloc(), so it allocates nothing.
[[maybe_unused]] void* checked_allocation(void* memory, std::size_t bytes) {
  if (memory != nullptr || bytes == 0 || !is_armed.exchange(false)) return memory;
  write_answer(allocation_descriptor, allocation_report);
  errno = ENOMEM;
  return nullptr;
}

}  // namespace

void report_failed_allocations(int descriptor, const std::string& text) {
  allocation_report = packed_message(AnswerKind::machine, text);
  allocation_descriptor = descriptor;
  is_armed = true;
}

}  // namespace simvis

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

// The program's functions take the place of those of the C library in all of its libraries. The C library exports its
// own under these names for this purpose; free() stays as it is.
extern "C" {
void* malloc_of_c_library(std::size_t bytes) __asm__("__libc_malloc");
void* calloc_of_c_library(std::size_t count, std::size_t bytes) __asm__("__libc_calloc");
void* realloc_of_c_library(void* memory, std::size_t bytes) __asm__("__libc_realloc");

__attribute__((visibility("default"))) void* malloc(std::size_t bytes) {
  return simvis::checked_allocation(malloc_of_c_library(bytes), bytes);
}
__attribute__((visibility("default"))) void* calloc(std::size_t count, std::size_t bytes) {
  return simvis::checked_allocation(calloc_of_c_library(count, bytes), bytes == 0 ? 0 : count);
}
__attribute__((visibility("default"))) void* realloc(void* memory, std::size_t bytes) {
  return simvis::checked_allocation(realloc_of_c_library(memory, bytes), bytes);
}
}

#endif
