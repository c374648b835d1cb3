// The host cost of one sensor's own work, in instrumented simulations. Plain data.
#pragma once

#include <cstdint>
#include <string>

namespace simvis {

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
