// Asks the device when it was where in a frame, and what it has counted. Exists on instrumented devices only.
#pragma once

#include <vector>

#include "engine/frame_costs.h"
#include "engine/frame_plan.h"
#include "engine/handle.h"

namespace simvis {

/// Stamps stand in the order in which they are recorded:
///   begin; uploads done; of each pass: begin, each view's end, end; of each pass: its results copied.
class GpuQueries {
 public:
  explicit GpuQueries(Device::Impl& device);

  /// The first commands of a frame.
  void begin(VkCommandBuffer commands, const FramePlan& plan);

  /// Takes the time when all that was recorded so far is done.
  void stamp(VkCommandBuffer commands);

  /// What is recorded between the two is counted; views in the order of the plan.
  void begin_view(VkCommandBuffer commands);
  void end_view(VkCommandBuffer commands);

  /// Of the frame that was begun last, once its submission has finished.
  FrameCosts costs(const FramePlan& plan) const;

 private:
  std::vector<std::int64_t> times() const;

  Device::Impl& device_;
  bool timed_ = false, counted_ = false;
  Handle<VkQueryPool> stamps_, statistics_;
  std::uint32_t stamps_held_ = 0, views_held_ = 0;  // by the pools
  std::uint32_t stamp_ = 0, view_ = 0;              // the next
};

}  // namespace simvis
