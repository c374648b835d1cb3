// A readable report of what a frame rendered, why, and at what cost.
#pragma once

#include <span>
#include <string>

#include <simvis/frame_costs.h>
#include <simvis/frame_plan.h>
#include <simvis/frame_results.h>
#include <simvis/step_costs.h>

namespace simvis {

/// The costs of a frame. The costs of the device and of sensors are optional.
struct ExplainedCosts {
  const FrameCounters& counters;
  const FrameCosts* device = nullptr;
  std::span<const SensorCost> sensors{};
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
std::string explain(const FramePlan& plan, const ExplainedCosts& costs);

}  // namespace simvis
