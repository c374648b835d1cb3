// Timestamp and pipeline-statistics queries of a frame. Used on instrumented devices only.
#pragma once

#include <optional>
#include <vector>

#include <simvis/frame_costs.h>
#include <simvis/frame_plan.h>
#include "engine/render/frame_draw_lists.h"
#include "engine/vulkan/handle.h"

namespace simvis {

/// Timestamps are stored in the order in which they are recorded:
///   begin; uploads done; for each pass in drawing_order(): begin, end of each view, end; for each pass: results
///   copied.
class GpuQueries {
 public:
  explicit GpuQueries(DeviceImpl& device);

  /// Records the first commands of a frame.
  void begin(VkCommandBuffer commands, const FramePlan& plan);

  /// Records a timestamp that is written when all commands recorded so far are complete.
  void stamp(VkCommandBuffer commands);

  /// Count the commands recorded between the two calls for one view and one phase. `view` is the index among all views
  /// of the plan. Each phase is counted once: if OIT layers are drawn in bands, only the first band is counted. A
  /// pipeline must be bound before begin_draws(): Mesa's lavapipe 22.3 crashes if a query begins without one.
  void begin_draws(VkCommandBuffer commands, std::size_t view, DrawPhase share);
  void end_draws(VkCommandBuffer commands);

  /// Returns the costs of the frame that was begun last. Its submission must have finished.
  FrameCosts costs(const FramePlan& plan) const;

 private:
  std::vector<std::int64_t> times() const;
  PipelineStatistics statistics(std::size_t view) const;  // sum over all phases

  DeviceImpl& device_;
  bool timed_ = false, counted_ = false;
  Handle<VkQueryPool> stamps_, statistics_;
  std::uint32_t stamps_held_ = 0, counts_held_ = 0;  // capacities of the pools
  std::uint32_t stamp_ = 0;                          // index of the next timestamp
  std::vector<std::uint8_t> drawn_;                  // by view and phase: not 0 if it was counted
  std::optional<std::uint32_t> counting_;            // index of the query that is active
};

}  // namespace simvis
