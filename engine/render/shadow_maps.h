// Shadow map data that colour views read: the atlas, and the place of each light's map in it.
#pragma once

#include <vector>

#include <simvis/frame_plan.h>
#include "engine/vulkan/buffer.h"
#include "engine/vulkan/descriptor_sets.h"
#include "engine/vulkan/uploads.h"
#include "shaders/interop.h"

namespace simvis {

/// The row before the blocks of a view: the ray through the point (x, y) of the targets of its pass has the direction
/// ((x, y) - row.xy) * row.zw, 1 in the view frame. `supersampling` is that of the pass.
glm::vec4 pixel_row(const View& view, std::uint32_t supersampling);

/// Returns the blocks of view.shadows, in their order. `maps`: the pass of the plan that draws the shadow maps.
std::vector<shader::ShadowBlock> shadow_blocks(const View& view, const Pass& maps);

/// Created for the first frame that has a shadow. The host writes the descriptor set while no submission is in flight.
class ShadowMaps {
 public:
  ShadowMaps(DeviceImpl& device, const DescriptorLayout& set_layout);

  /// Writes the rows of pixels and the blocks of all colour views of a plan, in the order of the plan.
  void write(const FramePlan& plan, const Pass& maps, Uploads& uploads);
  void show(const GpuImage& atlas);

  /// Appends the buffer of this object to `memory`. The maps themselves are the target of a pass.
  void name_memory(const Uploads& uploads, std::vector<PlannedMemory>& memory) const;

  VkDescriptorSet set() const { return set_.get(); }
  /// The first texel of a view's blocks, which its row of pixels precedes. `shadowed`: the index of the view among the
  /// views that have shadows.
  std::uint32_t first_texel(std::size_t shadowed) const { return first_texels_[shadowed]; }

 private:
  DeviceImpl& device_;
  const DescriptorLayout& set_layout_;
  DescriptorSets set_;
  Handle<VkSampler> sampler_;
  Buffer blocks_;
  Handle<VkBufferView> texels_;  // of blocks_
  std::vector<std::uint32_t> first_texels_;
};

}  // namespace simvis
