// The limits of the program that reads USD, which Python sets through this library once its modules are there.
#include <cstddef>
#include <cstring>
#include <exception>
#include <span>

#include "programs/process_limits.h"

/// Limits the process as limit_process() does. Returns 0, or 1 with the reason in `reason`, which has `size` bytes.
extern "C" __attribute__((visibility("default"))) int simvis_limit_process(std::size_t memory_bytes,
                                                                           const char* const* folders, int count,
                                                                           char* reason, std::size_t size) try {
  const std::span names(folders, static_cast<std::size_t>(count));
  simvis::limit_process({.memory_bytes = memory_bytes, .folders = {names.begin(), names.end()}});
  return 0;
} catch (const std::exception& error) {
  std::strncpy(reason, error.what(), size - 1);
  reason[size - 1] = '\0';
  return 1;
}
