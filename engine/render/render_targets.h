// Render target images and readback buffers of passes, kept from frame to frame.
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
  std::uint32_t width = 0, height = 0, supersampling = 1, msaa = 1;  ///< as in the pass
  bool shadow_maps = false;
  GpuImage depth;          ///< one value per sample
  GpuImage color;          ///< one value per pixel, mapped if the device can do so; empty for depth passes
  GpuImage items;          ///< one index per pixel, mapped if the device can do so; empty unless the pass has items
  GpuImage color_samples;  ///< one value per sample, for passes with several samples per pixel
  ResolvePass::Binding average;  ///< resolves color_samples to color
  Handle<VkFramebuffer> framebuffer;
  Buffer depth_readback, color_readback, items_readback;  ///< created when first needed; none of mapped images
  std::uint64_t last_frame = 0;
  std::uint64_t number = 0;  ///< counts all targets from 1: no two have the same
};

class RenderTargets {
 public:
  RenderTargets(DeviceImpl& device, Pipelines& pipelines, ResolvePass& average)
      : device_(device), pipelines_(pipelines), average_(average) {}

  /// Starts a frame: all targets become free. Targets that have not been used for many frames are destroyed.
  void begin_frame();

  /// Appends the images and buffers of all targets to `memory`. `user` returns the pass of this frame that uses a
  /// target, or null.
  void name_memory(const std::function<const Pass*(const RenderTarget&)>& user,
                   std::vector<PlannedMemory>& memory) const;

  /// Returns a target that only this pass uses until the next begin_frame().
  RenderTarget& acquire(const Pass& pass);

 private:
  std::unique_ptr<RenderTarget> make(const Pass& pass) const;
  GpuImage make_read(const Pass& pass, const char* what, VkFormat format, VkImageUsageFlags usage) const;
  GpuImage make_image(const Pass& pass, const char* what, VkFormat format, VkImageUsageFlags usage, bool samples) const;

  DeviceImpl& device_;
  Pipelines& pipelines_;
  ResolvePass& average_;
  std::vector<std::unique_ptr<RenderTarget>> targets_;
  std::uint64_t frame_ = 0;
  std::uint64_t made_ = 0;  // targets so far
};

}  // namespace simvis
