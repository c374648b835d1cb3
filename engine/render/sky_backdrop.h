// The picture of the sky where a view of colour hits nothing.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/frame_plan.h>
#include "engine/render/pipelines.h"
#include "engine/vulkan/gpu_image.h"
#include "engine/vulkan/uploads.h"

namespace simvis {

/// Created for the first frame that shows a picture. The host writes the descriptor set while no submission is in
/// flight.
class SkyBackdrop {
 public:
  SkyBackdrop(DeviceImpl& device, Pipelines& pipelines);

  /// Uploads the picture, which is not null, unless it is the one that is held. Throws InputError if it is larger than
  /// the device allows.
  void show(const std::shared_ptr<const SkyPicture>& picture, Uploads& uploads);

  /// Draws what the view shows of the picture behind what the pass has drawn so far; viewport and scissor are set.
  /// Returns whether the pipeline was made for it.
  bool record(VkCommandBuffer commands, const DrawList& list, const Pass& pass, const View& view);

  /// Appends the image of this object to `memory`.
  void name_memory(const Uploads& uploads, std::vector<PlannedMemory>& memory) const;

 private:
  VkPipeline pipeline(std::uint32_t samples);

  DeviceImpl& device_;
  Pipelines& pipelines_;
  Handle<VkShaderModule> vert_, frag_;
  Handle<VkSampler> sampler_;
  DescriptorSets set_;
  std::shared_ptr<const SkyPicture> picture_;  // in image_
  GpuImage image_;
  std::map<std::uint32_t, Handle<VkPipeline>> made_;  // by samples
};

}  // namespace simvis
