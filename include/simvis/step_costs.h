// The time that the parts of a step took: its stages, and the work of each sensor.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace simvis {

/// One stage of a step, on the steady clock. "render" ends when the GPU has finished and host-only ray casts are
/// complete; with step_async() it includes what the caller did between the two halves.
struct StageTime {
  std::string_view name;      ///< "elements", "flatten", "plan", "render", "collect" or "visualization"
  std::int64_t start_ns = 0,  ///< begin of the stage
      end_ns = 0;             ///< end of the stage
};

/// The host cost of one sensor in one frame. Times are of the steady clock, in ascending order.
struct SensorCost {
  std::string sensor;             ///< the sensor's name
  std::int64_t start_ns = 0;      ///< before it reads the results of its passes
  std::int64_t collected_ns = 0;  ///< after it has read these results
  std::int64_t end_ns = 0;        ///< after it has cast its rays, if it casts any
  std::uint64_t rays = 0;         ///< rays cast, see RayCounters
  std::uint64_t item_tests = 0,   ///< see RayCounters
      triangle_tests = 0;         ///< see RayCounters
};

}  // namespace simvis
