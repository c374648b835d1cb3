// How a simulation's last step was planned, drawn and paid for.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include <simvis/command.h>
#include <simvis/device.h>
#include <simvis/draw_list.h>
#include <simvis/frame_costs.h>
#include <simvis/frame_plan.h>
#include <simvis/frame_results.h>
#include <simvis/ray_caster.h>
#include <simvis/sensor_cost.h>
#include <simvis/stage_time.h>

namespace simvis {

struct SimulationImpl;

/// A view of a simulation for tests, benchmarks and reports. No measurement depends on it.
///
/// Lifetime   valid as long as the simulation that gave it; what its functions return is valid until the next step.
/// Errors     InputError while a frame is under way (see Simulation::step_async()), except from device() and stages().
/// Threading  as the simulation.
class Diagnostics {
 public:
  explicit Diagnostics(SimulationImpl& simulation) : impl_(&simulation) {}

  /// The command that made a sensor, as it was executed: with overrides, its preset written out, and with its names and
  /// insertion point as the part that carries it has given them. Throws InputError when there is no such sensor.
  const Command& command(std::string_view sensor) const;

  const DeviceInfo& device() const;
  const FrameCounters& counters() const;  ///< of the last step()
  RayCounters ray_counters() const;       ///< of all steps
  const DrawList& draw_list() const;      ///< of the last step()
  const FramePlan& frame_plan() const;    ///< of the last step(), complete: see engine/frame_plan.h
  /// Of the last step(); null unless SimulationDesc::device is instrumented.
  const FrameCosts* frame_costs() const;
  /// The same of what visualization cameras saw. Null while the scene has none.
  const FramePlan* visualization_plan() const;
  const FrameCounters* visualization_counters() const;
  const FrameCosts* visualization_costs() const;
  /// Of the sensors that measured in the last step(), in this order; empty unless the device is instrumented.
  std::span<const SensorCost> sensor_costs() const;
  /// All that SimVis holds of the device's memory: what the plans name, and nothing else.
  std::uint64_t device_memory_bytes() const;
  /// The stages of the last step(), in order. Empty before the first.
  std::span<const StageTime> stages() const;
  std::uint64_t validation_messages() const;

 private:
  SimulationImpl* impl_;
};

}  // namespace simvis
