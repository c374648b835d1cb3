// The monotonic clock for measuring durations.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace simvis {

/// Nanoseconds since a fixed time of the process. The value never decreases.
inline std::int64_t now_ns() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
}

/// A duration of at least 0 s as nanoseconds; at most 146 years, so that now_ns() with it is a number of 64 bits.
inline std::int64_t limited_ns(double seconds) {
  constexpr double kLongest_s = 4.6e9;
  return static_cast<std::int64_t>(std::min(seconds, kLongest_s) * 1e9);
}

}  // namespace simvis
