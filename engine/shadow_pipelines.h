// What pipelines of scenes with shadows need besides the rest: made when the first of them is wanted.
#pragma once

#include "engine/handle.h"

namespace simvis {

struct ShadowPipelines {
  /// `frame_set` and `texture_set`: of all pipelines of meshes, see Pipelines.
  ShadowPipelines(Device::Impl& device, VkDescriptorSetLayout frame_set, VkDescriptorSetLayout texture_set);

  Handle<VkDescriptorSetLayout> set_layout;  ///< SIMVIS_SHADOW_SET
  Handle<VkPipelineLayout> layout;           ///< that of all meshes, and this set behind it
  Handle<VkShaderModule> map_frag;           ///< the depth of opaque surfaces in a shadow map
  Handle<VkShaderModule> map_mask_frag[2];   ///< of surfaces with holes, without and with a texture
  Handle<VkShaderModule> color_frag[2];      ///< colour with shadows on it, likewise
  Handle<VkShaderModule> mapped_frag;        ///< and of surfaces with maps
};

}  // namespace simvis
