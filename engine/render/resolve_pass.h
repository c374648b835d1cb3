// Takes colour images with several samples per pixel to their mean, on the device.
#pragma once

#include <unordered_map>

#include <simvis/frame_plan.h>
#include "engine/vulkan/gpu_image.h"

namespace simvis {

/// From an image of pass.grid times the pass's width and height, each texel with pass.msaa samples, to one of the
/// pass's size. Makes nothing before it is first used.
class ResolvePass {
 public:
  explicit ResolvePass(Device::Impl& device) : device_(device) {}

  /// A pair of images as the shader sees it; it must not outlive them.
  struct Binding {
    Handle<VkDescriptorPool> pool;
    VkDescriptorSet set = VK_NULL_HANDLE;  // freed with its pool
  };
  /// `samples` has been made for VK_IMAGE_USAGE_SAMPLED_BIT, `mean` for VK_IMAGE_USAGE_STORAGE_BIT.
  Binding bind(const GpuImage& samples, const GpuImage& mean);

  /// `samples` is in the layout SHADER_READ_ONLY_OPTIMAL. Leaves `mean` ready to be copied from.
  void record(VkCommandBuffer commands, const Pass& pass, const Binding& binding, const GpuImage& mean);

  std::size_t made() const { return pipelines_.size(); }  ///< pipelines, so far
  /// Which of them a pass takes.
  static std::uint32_t pipeline_key(const Pass& pass) { return pass.supersampling << 8 | pass.msaa; }

 private:
  void make_layouts();
  VkPipeline pipeline(const Pass& pass);

  Device::Impl& device_;
  Handle<VkDescriptorSetLayout> set_layout_;
  Handle<VkPipelineLayout> layout_;
  std::unordered_map<std::uint32_t, Handle<VkPipeline>> pipelines_;
};

}  // namespace simvis
