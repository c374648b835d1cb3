// Instrumentation of a simulation: how its last step was planned and drawn, and what it cost.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/command.h>
#include <simvis/device_info.h>
#include <simvis/draw_list.h>
#include <simvis/export.h>
#include <simvis/frame_costs.h>
#include <simvis/frame_plan.h>
#include <simvis/frame_results.h>
#include <simvis/ray_caster.h>
#include <simvis/step_costs.h>

namespace simvis {

struct SimulationImpl;

/// A view of a simulation for tests, benchmarks and reports. No measurement depends on it.
///
/// Lifetime   valid as long as the simulation that gave it; references that its functions return are
///            valid until the next step or Simulation::execute().
/// Errors     InputError while a frame is under way (see Simulation::step_async()), except from command(), device(),
///            inputs(), environment() and validation_messages().
/// Threads    as the simulation: one thread at a time.
class SIMVIS_API Diagnostics {
 public:
  /// Made by Simulation::diagnostics().
  explicit Diagnostics(SimulationImpl& simulation) : impl_(&simulation) {}

  /// The command that made a sensor, as executed: with overrides applied, its preset expanded, and with the names and
  /// the insertion point that the part which carries it has given them. Throws InputError if there is no such sensor.
  const Command& command(std::string_view sensor) const;

  /// The device that renders; null while nothing has needed one. It is open from the start if a sensor draws, or if
  /// SimulationDesc::device selects one or wants it instrumented.
  const DeviceInfo* device() const;
  /// The files that the scene and its parts were read from, by the names with which they were opened, sorted, each
  /// once.
  std::span<const std::filesystem::path> inputs() const;
  /// The environment variables that were read on the way to those files, with their values; none: not set.
  const std::map<std::string, std::optional<std::string>>& environment() const;
  const FrameCounters& counters() const;  ///< of the last step()
  RayCounters ray_counters() const;       ///< sum over all steps
  std::uint64_t motions_followed()
      const;  ///< poses, items and joints compared with their previous frame, over all steps
  /// The draw list of the last step(), or of the loaded scene before the first step. Shapes that no
  /// sensor needs are not read, and so not among its items; nor are pictures, whose textures are one white texel.
  const DrawList& draw_list() const;
  const FramePlan& frame_plan() const;  ///< of the last step(), complete: see <simvis/frame_plan.h>
  /// All sensors that frame_plan() is for, due or not.
  std::vector<PlannedSensor> planned_sensors() const;
  /// Device times and counts of the last step(). Null unless SimulationDesc::device is instrumented.
  const FrameCosts* frame_costs() const;
  /// The plan of the views of visualization cameras. Null while the scene has none.
  const FramePlan* visualization_plan() const;
  /// All sensors that visualization_plan() is for, due or not.
  std::vector<PlannedSensor> visualization_sensors() const;
  const FrameCounters* visualization_counters() const;  ///< of these views; null while the scene has no such camera
  const FrameCosts* visualization_costs() const;        ///< of these views; null also unless instrumented
  /// Host costs of the sensors that measured in the last step(), in the order in which they measured. Empty unless the
  /// device is instrumented.
  std::span<const SensorCost> sensor_costs() const;
  /// All device memory that SimVis holds, in bytes: exactly what the plans name.
  std::uint64_t device_memory_bytes() const;
  /// The stages of the last step(), in order. Empty before the first.
  std::span<const StageTime> stages() const;
  /// Errors and warnings of the validation layer since the simulation was loaded (0 if the layer is off).
  std::uint64_t validation_messages() const;

 private:
  SimulationImpl* impl_;
};

}  // namespace simvis
