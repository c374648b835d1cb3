// Units of time as numbers of nanoseconds.
#pragma once

#include <cstdint>

namespace simvis {

inline constexpr std::int64_t kMicrosecond_ns = 1000;

}  // namespace simvis
