// The monotonic clock for measuring durations.
#pragma once

#include <chrono>
#include <cstdint>

namespace simvis {

/// Nanoseconds since a fixed time of the process. The value never decreases.
inline std::int64_t now_ns() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
}

}  // namespace simvis
