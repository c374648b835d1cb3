// Times frames in which one sensor measures alone, for lists of costs.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "program/report/cost_desc.h"
#include "program/report/run_report.h"
#include "simvis/time/clock.h"

namespace simvis {

/// The times of one frame.
struct FrameTimes {
  double wall_ms = 0;
  double processor_ms = 0;  ///< of all threads of the process
};

/// Sets the times of a row of costs: the median and the quartiles of the frames, and the median of their processor
/// times. There is at least one frame.
template <class Costs>
void set_times(std::span<const FrameTimes> frames, Costs& costs) {
  std::vector<double> wall_ms, processor_ms;
  for (const FrameTimes& frame : frames) {
    wall_ms.push_back(frame.wall_ms);
    processor_ms.push_back(frame.processor_ms);
  }
  costs.first_quartile_ms = percentile(wall_ms, 25);
  costs.median_ms = percentile(wall_ms, 50);
  costs.third_quartile_ms = percentile(wall_ms, 75);
  costs.processor_ms = percentile(processor_ms, 50);
}

/// "CAM: colour, 15 frames of each, load 0.31 at the start\n": the line above a table of costs.
std::string cost_title(const std::string& sensor, std::uint64_t frames, double load);

/// `desc` must live as long as the object.
class CostRun {
 public:
  /// Turns all sensors off. Frames are `apart`, if given, else at the simulation's rate.
  CostRun(Simulation simulation, const CostDesc& desc, std::optional<std::chrono::nanoseconds> apart = {});

  Simulation& simulation() { return simulation_; }
  /// The processes that ran or waited for a processor when the object was made, as the mean of a minute; NaN: unknown.
  double load() const { return load_; }

  /// A name that no sensor of the scene has: names in a scene contain no dot.
  static std::string variant_name(const std::string& sensor, std::size_t number);

  /// Adds a sensor with this command and this name where `sensor` is, turned off. It is to make so many frames.
  void add(const std::string& sensor, const Command& command, const std::string& name, std::uint64_t frames);
  /// The frames of a sensor that is timed in each turn.
  std::uint64_t frames_of_turns() const { return 2 * (desc_.warm_up + desc_.frames); }

  /// The time of `frame` in which this variant measures alone, after the frame before it. Throws InputError if it does
  /// not measure; `what` names the sensor of the scene.
  FrameTimes time(const std::string& variant, const std::string& what, std::uint64_t frame);
  /// The same without the frame before it.
  FrameTimes time_alone(const std::string& variant, const std::string& what, std::uint64_t frame);

 private:
  FrameTimes step(std::uint64_t frame);

  Simulation simulation_;
  const CostDesc& desc_;
  std::optional<std::chrono::nanoseconds> apart_;
  Clock clock_;
  double load_;
  std::uint64_t frames_done_ = 0, all_frames_ = 0;
};

}  // namespace simvis
