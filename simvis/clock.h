// When frames are taken and when sensors fire: pure functions of the frame's number, in whole nanoseconds.
#pragma once

#include <cstdint>

#include <simvis/sensor.h>

namespace simvis {

/// A rate as people write it: hertz = digits * 10^exponent.
struct DecimalRate {
  std::uint64_t digits = 0;  ///< below 10^17
  int exponent = 0;
};

/// The shortest decimal number that reads back as `rate_hz`, which is finite and above 0. So 0.1 Hz is one frame in
/// 10 s exactly, although no double is 0.1.
DecimalRate decimal_rate(double rate_hz);

/// Time     frame k is taken at k * 10^9 / rate nanoseconds, rounded to the nearest (halves up). It is worked out in
///          integers from the decimal rate, so no error adds up, however many frames there are.
/// Errors   InputError from the constructor when the rate is not finite, not above 0, above 10^9 Hz (frames cannot be
///          told apart) or so low that a frame outlasts the 292 years that 64 bits of nanoseconds hold; from `frame`
///          when that frame lies beyond them.
class Clock {
 public:
  static constexpr double kMaxRateHz = 1e9;

  explicit Clock(double rate_hz);

  FrameTime frame(std::uint64_t index) const;

  /// Whether a sensor with `sensor_rate_hz` measures in frame `index`: a firing time round(j * 10^9 / sensor_rate),
  /// j = 0, 1, 2, ..., lies after the frame before and not after this one. Frame 0 takes the firing at time 0. A sensor
  /// that is faster than the frames measures once in each. 0 = every frame.
  bool fires(double sensor_rate_hz, std::uint64_t index) const;

 private:
  double rate_hz_;
  DecimalRate rate_;
  std::int64_t period_ns_;
};

}  // namespace simvis
