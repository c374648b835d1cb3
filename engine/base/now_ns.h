// The clock that durations are measured by.
#pragma once

#include <chrono>
#include <cstdint>

namespace simvis {

/// Nanoseconds since a moment that stays the same within a process. It never goes back.
inline std::int64_t now_ns() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
}

}  // namespace simvis
