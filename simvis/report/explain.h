// What was rendered, why, and what it cost, for people.
#pragma once

#include <span>
#include <string>

#include <simvis/frame_costs.h>
#include <simvis/frame_plan.h>
#include <simvis/frame_results.h>
#include <simvis/sensor_cost.h>

namespace simvis {

/// What a frame cost. Without a device's and sensors' own figures those are left out.
struct ExplainedCosts {
  const FrameCounters& counters;
  const FrameCosts* device = nullptr;
  std::span<const SensorCost> sensors{};
};

/// A tree, two spaces deeper at each level:
///
///   sensor: why it is due or not, and its outputs
///     effects; passes, of each its views, of each its pipelines; casts
///   passes and casts of no sensor
///   memory: each buffer and image
///   the counters of the frame
///
/// with the reason of each, and a line "cost" where there is one.
std::string explain(const FramePlan& plan, const ExplainedCosts& costs);

}  // namespace simvis
