// How costs are measured.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <simvis/sensor.h>
#include <simvis/simulation_desc.h>
#include <simvis/trajectory.h>

namespace simvis {

struct CostDesc {
  std::uint64_t frames = 15;                  ///< each variant is timed in frames 1 to `frames` of a run; at least 1
  std::uint64_t warm_up = 1;                  ///< number of untimed turns at frame 1 before that
  double rate_hz = SimulationDesc{}.rate_hz;  ///< frame rate along the trajectory
  const Trajectory* trajectory = nullptr;
  /// Which of a scanner's variants are measured.
  std::vector<ScanVariant> ScanVariants::*variants = &ScanVariants::priced;
  /// Called after every frame; an exception from it ends the measurement.
  std::function<void(std::uint64_t done, std::uint64_t all)> on_frame{};
};

}  // namespace simvis
