// Images that passes draw into, and the buffers that they are read back through. Kept from frame to frame.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include <simvis/frame_plan.h>
#include "engine/render/pipelines.h"
#include "engine/render/resolve_pass.h"
#include "engine/vulkan/buffer.h"
#include "engine/vulkan/gpu_image.h"

namespace simvis {

struct RenderTarget {
  std::uint32_t width = 0, height = 0, supersampling = 1, msaa = 1;  ///< as the pass's
  bool shadow_maps = false;
  GpuImage depth;                ///< of each sample
  GpuImage color;                ///< of each pixel; none for depth passes
  GpuImage color_samples;        ///< of each sample, for passes with more than one a pixel
  ResolvePass::Binding average;  ///< of the latter to the former
  Handle<VkFramebuffer> framebuffer;
  Buffer depth_readback, color_readback;  ///< made when first wanted
  std::uint64_t last_frame = 0;
};

class RenderTargets {
 public:
  RenderTargets(Device::Impl& device, Pipelines& pipelines, ResolvePass& average)
      : device_(device), pipelines_(pipelines), average_(average) {}

  /// Starts a frame: all targets are free again. Those that no frame has wanted for long are given up.
  void begin_frame();

  /// Adds the images and buffers of all that are held; `user` says which pass of this frame has a target, null: none.
  void name_memory(const std::function<const Pass*(const RenderTarget&)>& user,
                   std::vector<PlannedMemory>& memory) const;

  /// A target for this pass alone, until the next begin_frame().
  RenderTarget& acquire(const Pass& pass);

 private:
  std::unique_ptr<RenderTarget> make(const Pass& pass) const;
  GpuImage make_image(const Pass& pass, const char* what, VkFormat format, VkImageUsageFlags usage, bool samples) const;

  Device::Impl& device_;
  Pipelines& pipelines_;
  ResolvePass& average_;
  std::vector<std::unique_ptr<RenderTarget>> targets_;
  std::uint64_t frame_ = 0;
};

}  // namespace simvis
