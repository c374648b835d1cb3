// What pipelines of scenes with shadows need besides the rest: made when the first of them is wanted.
#pragma once

#include <span>

#include "engine/vulkan/descriptor_sets.h"

namespace simvis {

struct ShadowPipelines {
  /// `mesh_sets`: of all pipelines of meshes, see Pipelines.
  ShadowPipelines(Device::Impl& device, std::span<const VkDescriptorSetLayout> mesh_sets);

  DescriptorLayout set_layout;              ///< SIMVIS_SHADOW_SET
  Handle<VkPipelineLayout> layout;          ///< that of all meshes, and this set behind it
  Handle<VkShaderModule> map_frag;          ///< the depth of opaque surfaces in a shadow map
  Handle<VkShaderModule> map_mask_frag[2];  ///< of surfaces with holes, without and with a texture
  Handle<VkShaderModule> color_frag[3];     ///< colour with shadows on it, likewise and with maps
  Handle<VkShaderModule> layer_frag[3];     ///< of transparent surfaces
};

}  // namespace simvis
