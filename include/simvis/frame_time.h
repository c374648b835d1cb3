// The simulated time of a frame, as sensors and effects get it.
#pragma once

#include <cstdint>

namespace simvis {

/// The time at which a frame is taken.
struct FrameTime {
  std::uint64_t index = 0;     ///< 0, 1, 2, ...
  std::int64_t time_ns = 0;    ///< simulated time
  std::int64_t period_ns = 0;  ///< time from one frame to the next
};

}  // namespace simvis
