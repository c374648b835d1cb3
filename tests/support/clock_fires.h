// When a sensor measures, counted in frames of a fixed rate.
#pragma once

#include <cstdint>

#include "simvis/time/clock.h"

namespace simvis {

/// Whether a sensor measures in frame `index`. Frame 0 takes the firing at time 0.
inline bool fires_in(const Clock& clock, double sensor_rate_hz, std::uint64_t index) {
  if (index == 0) return true;
  return fires_between(sensor_rate_hz, clock.frame(index - 1).time_ns, clock.frame(index).time_ns);
}

}  // namespace simvis
