// What a frame cost on an instrumented device, as the device itself says. Plain data.
#pragma once

#include <cstdint>
#include <vector>

namespace simvis {

/// Nanoseconds of the device's clock since the frame's first command, when all commands before each end were done.
struct GpuSpan {
  std::int64_t start_ns = 0, end_ns = 0;
  std::int64_t length_ns() const { return end_ns - start_ns; }
};

/// What Vulkan's pipeline statistics count (VkQueryPipelineStatisticFlagBits).
struct PipelineStatistics {
  std::uint64_t vertices = 0;            ///< read, as many times as indices name them
  std::uint64_t vertex_invocations = 0;  ///< of vertex shaders
  std::uint64_t primitives_clipped = 0;  ///< that reached clipping
  std::uint64_t primitives_drawn = 0;    ///< that came out of it: less what is outside, and what it was cut into
  /// Of fragment shaders. Means nothing in views without one (see View::shades): Mesa's llvmpipe counts what they
  /// cover.
  std::uint64_t fragment_invocations = 0;

  bool operator==(const PipelineStatistics&) const = default;
};

struct ViewCost {
  GpuSpan time;  ///< from the end of the view before it
  PipelineStatistics statistics;
};

struct PassCost {
  GpuSpan time;      ///< of the render pass; the views lie within
  GpuSpan readback;  ///< the mean of samples included
  std::uint64_t bytes_read_back = 0;
  std::vector<ViewCost> views;  ///< views[i] belongs to the pass's views[i]
};

/// Empty where the frame submitted nothing.
struct FrameCosts {
  bool timed = false;    ///< false: this device has no clock, and all its times are 0
  bool counted = false;  ///< false: this device has no pipeline statistics, and they are 0
  /// Steady clock of the host: just before the frame was handed over, and when it was known to be done. The device
  /// worked between the two.
  std::int64_t submitted_ns = 0, finished_ns = 0;
  GpuSpan uploads{};
  std::vector<PassCost> passes{};  ///< passes[i] belongs to the plan's passes[i]
};

}  // namespace simvis
