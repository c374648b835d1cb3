// The time from one measurement of a sensor to the next.
#pragma once

#include <algorithm>

#include <simvis/frame_time.h>

namespace simvis {

/// In seconds. A sensor with a rate measures in the first frame at or after each time that the rate gives: in every
/// frame if frames come less often, and otherwise at its rate, on average if the frames do not keep it. `rate_hz` 0 is
/// a sensor that measures in every frame.
inline double sample_period_s(double rate_hz, const FrameTime& time) {
  const double frame_s = static_cast<double>(time.period_ns) / 1e9;
  return rate_hz > 0 ? std::max(1 / rate_hz, frame_s) : frame_s;
}

}  // namespace simvis
