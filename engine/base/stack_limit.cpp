#include "engine/base/stack_limit.h"

#include <pthread.h>

#include <algorithm>
#include <cstddef>
#include <string>

#include <simvis/error.h>

namespace simvis {
namespace {

// A packet of rays needs more than 100 KiB. The system gives arguments and environment up to a quarter of the main
// thread's stack, so that a limit of 512 KiB is enough.
constexpr std::size_t kMinStackBytes = std::size_t{384} << 10;

// Fills in attributes by `get`, and returns the stack that they state; the least one that is allowed if there are none.
template <typename Get>
std::size_t stack_of(const Get& get) {
  pthread_attr_t attributes;
  if (get(&attributes) != 0) return kMinStackBytes;
  std::size_t bytes = 0;
  ::pthread_attr_getstacksize(&attributes, &bytes);
  ::pthread_attr_destroy(&attributes);
  return bytes;
}

}  // namespace

void require_stack() {
  const std::size_t own = stack_of([](pthread_attr_t* of) { return ::pthread_getattr_np(::pthread_self(), of); });
  const std::size_t others = stack_of([](pthread_attr_t* of) { return ::pthread_getattr_default_np(of); });
  const std::size_t bytes = std::min(own, others);
  if (bytes >= kMinStackBytes) return;
  throw MachineError("threads have a stack of " + std::to_string(bytes >> 10) + " KiB, expected at least " +
                     std::to_string(kMinStackBytes >> 10) + " KiB; ulimit -s 8192 sets the usual limit");
}

}  // namespace simvis
