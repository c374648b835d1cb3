// The limits of the programs in Python, which set them through this library once their modules are there.
#include <cstddef>
#include <cstring>
#include <exception>
#include <span>
#include <string_view>

#include "import/programs/process_limits.h"

/// Limits the process as limit_process() does; `program` is "usd" or "xacro". Returns 0, or 1 with the reason in
/// `reason`, which has `size` bytes.
extern "C" __attribute__((visibility("default"))) int simvis_limit_process(const char* program,
                                                                           std::size_t memory_bytes,
                                                                           const char* const* folders, int count,
                                                                           char* reason, std::size_t size) try {
  using simvis::HelperProgram;
  const std::span names(folders, static_cast<std::size_t>(count));
  const bool is_xacro = std::string_view(program) == "xacro";
  simvis::limit_process({.memory_bytes = memory_bytes,
                         .folders = {names.begin(), names.end()},
                         .program = is_xacro ? HelperProgram::xacro : HelperProgram::usd});
  return 0;
} catch (const std::exception& error) {
  std::strncpy(reason, error.what(), size - 1);
  reason[size - 1] = '\0';
  return 1;
}
