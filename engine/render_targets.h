// Images that passes draw into, and the buffers that they are read back through. Kept from frame to frame.
#pragma once

#include <memory>
#include <vector>

#include "engine/buffer.h"
#include "engine/frame_plan.h"
#include "engine/gpu_image.h"
#include "engine/pipelines.h"

namespace simvis {

struct RenderTarget {
  std::uint32_t width = 0, height = 0;
  GpuImage depth, color;  ///< no colour image for depth passes
  Handle<VkFramebuffer> framebuffer;
  Buffer depth_readback, color_readback;  ///< made when first wanted
  std::uint64_t last_frame = 0;
};

class RenderTargets {
 public:
  RenderTargets(Device::Impl& device, const Pipelines& pipelines) : device_(device), pipelines_(pipelines) {}

  /// Starts a frame: all targets are free again. Those that no frame has wanted for long are given up.
  void begin_frame();

  /// A target for this pass alone, until the next begin_frame().
  RenderTarget& acquire(const Pass& pass);

 private:
  std::unique_ptr<RenderTarget> make(const Pass& pass) const;

  Device::Impl& device_;
  const Pipelines& pipelines_;
  std::vector<std::unique_ptr<RenderTarget>> targets_;
  std::uint64_t frame_ = 0;
};

}  // namespace simvis
