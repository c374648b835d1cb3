// What views of colour read of shadow maps: the atlas, and where in it each light's map lies.
#pragma once

#include <vector>

#include <simvis/frame_plan.h>
#include "engine/vulkan/buffer.h"
#include "engine/vulkan/descriptor_sets.h"
#include "engine/vulkan/uploads.h"
#include "shaders/interop.h"

namespace simvis {

/// The blocks of view.shadows, in their order. `maps`: the plan's pass of shadow maps.
std::vector<shader::ShadowBlock> shadow_blocks(const View& view, const Pass& maps);

/// Made for the first frame that has a shadow; its descriptor set is written while nothing is in flight.
class ShadowMaps {
 public:
  ShadowMaps(Device::Impl& device, const DescriptorLayout& set_layout);

  /// Takes the blocks of all views of colour of a plan, in its order.
  void write(const FramePlan& plan, const Pass& maps, Uploads& uploads);
  void show(const GpuImage& atlas);

  /// Adds its buffer; the maps themselves are a pass's target.
  void name_memory(const Uploads& uploads, std::vector<PlannedMemory>& memory) const;

  VkDescriptorSet set() const { return set_.get(); }
  /// Where the blocks of the view lie that came as number `shadowed` of those that have any, in bytes.
  std::uint32_t offset(std::size_t shadowed) const { return offsets_[shadowed]; }

 private:
  Device::Impl& device_;
  const DescriptorLayout& set_layout_;
  DescriptorSets set_;
  Handle<VkSampler> sampler_;
  Buffer blocks_;
  std::vector<std::uint32_t> offsets_;
};

}  // namespace simvis
