// Asks the device when it was where in a frame, and what it has counted. Exists on instrumented devices only.
#pragma once

#include <optional>
#include <vector>

#include <simvis/frame_costs.h>
#include <simvis/frame_plan.h>
#include "engine/render/frame_draw_lists.h"
#include "engine/vulkan/handle.h"

namespace simvis {

/// Stamps stand in the order in which they are recorded:
///   begin; uploads done; of each pass, in drawing_order(): begin, each view's end, end; of each pass: its results
///   copied.
class GpuQueries {
 public:
  explicit GpuQueries(Device::Impl& device);

  /// The first commands of a frame.
  void begin(VkCommandBuffer commands, const FramePlan& plan);

  /// Takes the time when all that was recorded so far is done.
  void stamp(VkCommandBuffer commands);

  /// What is recorded between the two is counted for a view, by its number among all views of the plan, each share of
  /// it (see DrawPhase) once: of layers that are drawn in bands the first band's. The first of its pipelines is bound
  /// by then: Mesa's lavapipe 22.3 crashes where a query begins without one.
  void begin_draws(VkCommandBuffer commands, std::size_t view, DrawPhase share);
  void end_draws(VkCommandBuffer commands);

  /// Of the frame that was begun last, once its submission has finished.
  FrameCosts costs(const FramePlan& plan) const;

 private:
  std::vector<std::int64_t> times() const;
  PipelineStatistics statistics(std::size_t view) const;  // of all its shares

  Device::Impl& device_;
  bool timed_ = false, counted_ = false;
  Handle<VkQueryPool> stamps_, statistics_;
  std::uint32_t stamps_held_ = 0, counts_held_ = 0;  // by the pools
  std::uint32_t stamp_ = 0;                          // the next
  std::vector<std::uint8_t> drawn_;                  // by view and share: not 0 where it was counted
  std::optional<std::uint32_t> counting_;            // now
};

}  // namespace simvis
