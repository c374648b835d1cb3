// Faults between a sensor and the consumers of its measurements: delay, jitter, lost and repeated measurements, and a
// clock of the sensor's own. Attributes of every sensor:
//
//   <sensor type="imu" ... delay="0.02" delay_jitter="0.005" drop="0.01" clock_drift="20e-6"/>
//
// A measurement of the simulated time t
//   is lost        with the probability `drop`;
//   repeats        the numbers of the last measurement that was no repetition, lost or not, with the probability
//                  `freeze`;
//   arrives        at t + delay + u delay_jitter, with u uniform in [0, 1), and not before the measurements before it;
//   has the stamp  t + clock_offset + clock_drift t, or with stamp="arrival" the time at which it arrives.
// Times that the measurement itself gives, such as those of the beams of a sweep, are by the same clock.
//
// Consumers get it in the first frame at or after its arrival, one measurement in each frame. What is under way is lost
// when the sensor is switched off, and is not delivered at the end of a run.
//
// Every draw is named by seed, sensor and t: other sensors, frame rates and lost measurements do not change it.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/output_spec.h>

namespace simvis {

/// The names of the numbers that a sensor with timing faults gives beside its measurement: the true simulated times at
/// which its numbers were measured and at which it arrived, in seconds.
inline constexpr std::string_view kCaptureTime = "capture_time_s", kArrivalTime = "arrival_time_s";

enum class Stamp : std::uint8_t { capture, arrival };

struct TimingFaults {
  double delay_s = 0, delay_jitter_s = 0;      ///< least delay, and largest further one
  double drop = 0, freeze = 0;                 ///< probabilities
  double clock_offset_s = 0, clock_drift = 0;  ///< of the sensor's clock against simulated time, at time 0 and in s / s
  Stamp stamp = Stamp::capture;

  bool operator==(const TimingFaults&) const = default;

  /// Of a command that is checked against all_attributes(). Throws InputError at an attribute that has no effect.
  static TimingFaults of(const AttributeValues& attributes);
};

/// The rows of the attributes.
std::span<const AttributeSpec> timing_attributes();

/// The outputs kCaptureTime and kArrivalTime of sensors with timing faults.
std::vector<OutputSpec> timing_outputs();

}  // namespace simvis
