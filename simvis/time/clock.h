// The times of frames and of sensor firings: pure functions of the frame index, in whole nanoseconds.
#pragma once

#include <cstdint>
#include <optional>

#include <simvis/sensor.h>
#include "engine/base/program_api.h"

namespace simvis {

/// A rate in decimal notation: hertz = digits * 10^exponent.
struct DecimalRate {
  std::uint64_t digits = 0;  ///< below 10^17
  int exponent = 0;
};

/// The shortest decimal number that converts back to `rate_hz`, which must be finite and above 0. So 0.1 Hz is exactly
/// one frame in 10 s, although no double equals 0.1.
DecimalRate decimal_rate(double rate_hz);

/// Time     frame k is at k * 10^9 / rate nanoseconds, rounded to the nearest (halves up). It is computed in integers
///          from the decimal rate, so errors do not accumulate over any number of frames.
/// Errors   InputError from the constructor if the rate is not finite, not above 0, above 10^9 Hz (frames would have
///          equal times) or so low that one frame is longer than 292 years, the range of 64 bits of nanoseconds;
///          InputError from `frame` if the frame lies beyond that range.
class Clock {
 public:
  static constexpr double kMaxRateHz = 1e9;

  SIMVIS_PROGRAM_API explicit Clock(double rate_hz);

  SIMVIS_PROGRAM_API FrameTime frame(std::uint64_t index) const;

 private:
  double rate_hz_;
  DecimalRate rate_;
  std::int64_t period_ns_;
};

/// Whether a sensor with this rate measures in the frame at `now_ns`, the one before being at `before_ns`: a firing
/// time round(j * 10^9 / sensor_rate), j = 0, 1, 2, ..., lies after the previous frame and not after this one. A sensor
/// that is faster than the frames measures once in each frame. 0 = every frame.
bool fires_between(double sensor_rate_hz, std::int64_t before_ns, std::int64_t now_ns);

/// The first firing time after `after_ns` of a sensor with this rate, which is above 0; empty beyond the clock's range.
std::optional<std::int64_t> next_firing(double sensor_rate_hz, std::int64_t after_ns);

}  // namespace simvis
