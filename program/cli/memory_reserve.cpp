#include "program/cli/memory_reserve.h"

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

#include <simvis/error.h>

namespace simvis {
namespace {

// Nothing writes to it, so it is no memory of the machine until it is needed. To destroy the JSON of a frame takes a
// list of all its values, 16 bytes each; this is a million of them.
constexpr std::size_t kReservedBytes = std::size_t{16} << 20;

std::atomic<void*> reserved_memory = nullptr;
std::atomic<bool> reserve_is_used = false;

// What std::set_new_handler() calls when an allocation fails: the allocation is tried again after it returns.
void use_reserve() {
  void* const memory = reserved_memory.exchange(nullptr);
  if (memory == nullptr) throw std::bad_alloc();
  reserve_is_used = true;
  std::free(memory);
}

}  // namespace

void set_memory_aside() {
  reserved_memory = std::malloc(kReservedBytes);
  std::set_new_handler(use_reserve);
}

void require_memory() {
  if (reserve_is_used) throw MachineError("there is not enough memory");
}

}  // namespace simvis
