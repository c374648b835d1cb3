// A readable report of what a frame rendered, why, and at what cost.
#pragma once

#include <span>
#include <string>

#include <simvis/frame_costs.h>
#include <simvis/frame_plan.h>
#include <simvis/frame_results.h>
#include <simvis/step_costs.h>

namespace simvis {

/// The costs of a frame, and the sensors that it was planned for. All but the counters is optional.
struct ExplainedFrame {
  const FrameCounters& counters;
  std::span<const PlannedSensor> sensors{};
  const FrameCosts* device = nullptr;
  std::span<const SensorCost> sensor_costs{};
};

/// Returns a tree with two more spaces of indentation per level:
///
///   sensor: why it is due or not, and its outputs
///     effects; passes with their views and the pipelines of each view; casts
///   passes and casts of no sensor
///   memory: each buffer and image
///   the counters of the frame
///
/// Each entry has its reason, and a line "cost" if its cost is known.
std::string explain(const FramePlan& plan, const ExplainedFrame& frame);

}  // namespace simvis
