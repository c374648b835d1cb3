// What a run was and how fast it went: run.json and the closing lines.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <simvis/device.h>
#include <simvis/simulation.h>
#include "simvis/report/shard.h"

namespace simvis {

/// What run.json says.
struct RunReport {
  std::string scene;  ///< as given
  DeviceInfo device;
  std::uint64_t seed = 0;
  std::optional<Shard> shard{};  ///< if the run is one
  double rate_hz = 0;
  double wall_s = 0;             ///< from the start of the program to its last file
  std::vector<double> frame_ms;  ///< each step(), without writing files, which goes on beside it
  std::vector<SensorInfo> sensors;
};

/// The simulation's sensors, with the error bounds of their depth images: these are worked out here, if not before.
std::vector<SensorInfo> with_bounds(const Simulation& simulation);

/// The p-th percentile, 0 < p <= 100: the least value that at least p percent do not exceed. 0 for no values.
double percentile(std::span<const double> values, double p);

/// A bound that is not finite is null.
std::string to_json(const RunReport& report);

/// "30 frames, 2.43 ms a frame: 411.5 Hz, 27.43 x real time at 15 Hz", from the median.
std::string speed_line(const RunReport& report);

}  // namespace simvis
