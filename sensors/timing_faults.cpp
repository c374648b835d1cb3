#include "sensors/timing_faults.h"

#include <string>

#include <simvis/location.h>

namespace simvis {
namespace {

constexpr AttributeSpec kTimingAttributes[] = {
    {.name = "delay",
     .default_value = "0",
     .unit = "s",
     .text = "least time from a measurement to its arrival at consumers, see docs/sensors.md",
     .min = 0,
     .max = 1e6},
    {.name = "delay_jitter",
     .default_value = "0",
     .unit = "s",
     .text = "largest further delay, drawn uniformly for each measurement; they arrive in order",
     .min = 0,
     .max = 1e6},
    {.name = "drop", .default_value = "0", .text = "probability that a measurement never arrives", .min = 0, .max = 1},
    {.name = "freeze",
     .default_value = "0",
     .text = "probability that a measurement repeats the numbers of the one before it",
     .min = 0,
     .max = 1},
    {.name = "clock_offset",
     .default_value = "0",
     .unit = "s",
     .text = "by which the clock of the sensor's stamps is ahead at time 0",
     .min = 0,
     .max = 1e9},
    {.name = "clock_drift",
     .default_value = "0",
     .unit = "s/s",
     .text = "by which that clock gains in each second; 20e-6: 20 ppm",
     .min = -0.5,
     .max = 0.5},
    {.name = "stamp",
     .kind = AttributeKind::choice,
     .default_value = "capture",
     .text = "arrival: stamps are the time of arrival, as of a driver that stamps what it receives",
     .choices = "capture arrival"},
};

void refuse_idle_clock(const AttributeValues& a) {
  for (const std::string_view name : {"clock_offset", "clock_drift"}) {
    if (a.number(name) == 0) continue;
    fail_at(a.where(name),
            "attribute " + in_quotes(name) +
                " has no effect with stamp=\"arrival\", which is by the clock of the simulation, expected "
                "stamp=\"capture\", or none");
  }
}

}  // namespace

std::span<const AttributeSpec> timing_attributes() { return kTimingAttributes; }

TimingFaults TimingFaults::of(const AttributeValues& a) {
  const TimingFaults faults{.delay_s = a.number("delay"),
                            .delay_jitter_s = a.number("delay_jitter"),
                            .drop = a.number("drop"),
                            .freeze = a.number("freeze"),
                            .clock_offset_s = a.number("clock_offset"),
                            .clock_drift = a.number("clock_drift"),
                            .stamp = a.choice("stamp") == "arrival" ? Stamp::arrival : Stamp::capture};
  if (faults.stamp == Stamp::arrival) refuse_idle_clock(a);
  return faults;
}

std::vector<OutputSpec> timing_outputs() {
  const auto output = [](std::string_view name, const char* meaning) {
    return OutputSpec{.name = std::string(name), .unit = "s", .meaning = meaning, .on_request = true, .format = "%.9f"};
  };
  return {output(kCaptureTime, "true time at which the numbers were measured"),
          output(kArrivalTime, "true time at which the measurement arrived")};
}

}  // namespace simvis
