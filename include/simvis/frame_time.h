// The simulated time of a frame, as sensors and effects get it.
#pragma once

#include <cstdint>

namespace simvis {

/// The time at which a frame is taken.
struct FrameTime {
  std::uint64_t index = 0;     ///< 0, 1, 2, ...
  std::int64_t time_ns = 0;    ///< simulated time
  std::int64_t period_ns = 0;  ///< time from one frame to the next
  bool when_due = false;       ///< frames come when a sensor is due, so that `index` counts those of all sensors
};

/// What names the random numbers of a frame: its index, or its time in nanoseconds where sensors decide which frames
/// there are. So a sensor's numbers do not depend on the other sensors of the scene.
inline std::uint64_t random_key(const FrameTime& time) {
  return time.when_due ? static_cast<std::uint64_t>(time.time_ns) : time.index;
}

}  // namespace simvis
