// The clock as who measures in a frame sees it.
#pragma once

#include <cstdint>

namespace simvis {

/// When a frame is taken.
struct FrameTime {
  std::uint64_t index = 0;     ///< 0, 1, 2, ...
  std::int64_t time_ns = 0;    ///< simulated time
  std::int64_t period_ns = 0;  ///< from one frame to the next
};

}  // namespace simvis
