// Averages the samples of each pixel of a colour image, on the device.
#pragma once

#include <unordered_map>

#include <simvis/frame_plan.h>
#include "engine/vulkan/descriptor_sets.h"
#include "engine/vulkan/gpu_image.h"

namespace simvis {

/// The source image has pass.supersampling times the width and height of the pass, and pass.msaa samples per texel. The
/// result has the size of the pass. Vulkan objects are created on first use.
class ResolvePass {
 public:
  explicit ResolvePass(DeviceImpl& device) : device_(device) {}

  /// Descriptors of a pair of images. A binding must not outlive its images.
  using Binding = DescriptorSets;
  /// `samples` must have VK_IMAGE_USAGE_SAMPLED_BIT, `mean` must have VK_IMAGE_USAGE_STORAGE_BIT.
  Binding bind(const GpuImage& samples, const GpuImage& mean);

  /// The sample image must be in the layout SHADER_READ_ONLY_OPTIMAL. Afterwards `mean` is ready as a copy source.
  void record(VkCommandBuffer commands, const Pass& pass, const Binding& binding, const GpuImage& mean);

  std::size_t made() const { return pipelines_.size(); }  ///< number of pipelines so far
  /// The key of the pipeline that a pass uses.
  static std::uint32_t pipeline_key(const Pass& pass) { return pass.supersampling << 8 | pass.msaa; }

 private:
  void make_layouts();
  VkPipeline pipeline(const Pass& pass);

  DeviceImpl& device_;
  DescriptorLayout set_layout_;
  Handle<VkPipelineLayout> layout_;
  std::unordered_map<std::uint32_t, Handle<VkPipeline>> pipelines_;
};

}  // namespace simvis
