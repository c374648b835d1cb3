// What one sensor's own work cost on the host, of simulations that are instrumented. Plain data.
#pragma once

#include <cstdint>
#include <string>

namespace simvis {

/// Times on the steady clock, in the order of the members.
struct SensorCost {
  std::string sensor;
  std::int64_t start_ns = 0;
  std::int64_t collected_ns = 0;  ///< it has taken its results from the passes
  std::int64_t end_ns = 0;        ///< and has cast its rays, if it does
  std::uint64_t rays = 0;
  std::uint64_t item_tests = 0, triangle_tests = 0;  ///< see RayCounters
};

}  // namespace simvis
