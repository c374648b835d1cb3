// Times frames in which one sensor measures alone, for lists of costs.
#pragma once

#include <cstdint>
#include <string>

#include <simvis/simulation.h>
#include "program/report/cost_desc.h"
#include "simvis/time/clock.h"

namespace simvis {

/// The times of one frame.
struct FrameTimes {
  double wall_ms = 0;
  double processor_ms = 0;  ///< of all threads of the process
};

/// `desc` must live as long as the object.
class CostRun {
 public:
  /// Turns all sensors off.
  CostRun(Simulation simulation, const CostDesc& desc);

  Simulation& simulation() { return simulation_; }

  /// A name that no sensor of the scene has: names in a scene contain no dot.
  static std::string variant_name(const std::string& sensor, std::size_t number);

  /// Adds a sensor with this command and this name where `sensor` is, turned off.
  void add(const std::string& sensor, const Command& command, const std::string& name);

  /// The time of `frame` in which this variant measures alone, after the frame before it. Throws InputError if it does
  /// not measure; `what` names the sensor of the scene.
  FrameTimes time(const std::string& variant, const std::string& what, std::uint64_t frame);

 private:
  FrameTimes step(std::uint64_t frame);

  Simulation simulation_;
  const CostDesc& desc_;
  Clock clock_;
  std::uint64_t frames_done_ = 0, all_frames_ = 0;
};

}  // namespace simvis
