// The cost of a frame on an instrumented device, as measured by the device itself. Plain data.
#pragma once

#include <cstdint>
#include <vector>

namespace simvis {

/// A span of the device's clock in nanoseconds since the frame's first command. Each end is the time at which all
/// commands before it were complete.
struct GpuSpan {
  std::int64_t start_ns = 0,                                    ///< begin of the span
      end_ns = 0;                                               ///< end of the span
  std::int64_t length_ns() const { return end_ns - start_ns; }  ///< duration
};

/// Counts of Vulkan's pipeline statistics (VkQueryPipelineStatisticFlagBits).
struct PipelineStatistics {
  std::uint64_t vertices = 0;            ///< vertices read; a vertex counts as often as indices name it
  std::uint64_t vertex_invocations = 0;  ///< invocations of vertex shaders
  std::uint64_t primitives_clipped = 0;  ///< primitives that reached clipping
  std::uint64_t primitives_drawn =
      0;  ///< primitives that clipping put out: none for those outside, several for cut ones
  /// Invocations of fragment shaders. Meaningless in views without a fragment shader (see View::shades): Mesa's
  /// llvmpipe counts covered pixels there.
  std::uint64_t fragment_invocations = 0;

  bool operator==(const PipelineStatistics&) const = default;  ///< member by member
};

/// The cost of one view.
struct ViewCost {
  GpuSpan time;                   ///< starts at the end of the view before it
  PipelineStatistics statistics;  ///< all zero unless FrameCosts::counted
};

/// The cost of one pass.
struct PassCost {
  GpuSpan time;                       ///< of the render pass; contains the times of its views
  GpuSpan readback;                   ///< of the readback, including the averaging of samples
  std::uint64_t bytes_read_back = 0;  ///< copied to the host
  std::vector<ViewCost> views;        ///< views[i] belongs to the pass's views[i]
};

/// The cost of one frame. Empty if the frame submitted nothing.
struct FrameCosts {
  bool timed = false;              ///< false: this device has no clock, and all device times are 0
  bool counted = false;            ///< false: this device has no pipeline statistics, and they are 0
  std::int64_t submitted_ns = 0,   ///< steady clock of the host, just before the frame was submitted
      finished_ns = 0;             ///< steady clock of the host, when the frame was known to be complete
  GpuSpan uploads{};               ///< of all uploads of the frame
  std::vector<PassCost> passes{};  ///< passes[i] belongs to the plan's passes[i]
};

}  // namespace simvis
