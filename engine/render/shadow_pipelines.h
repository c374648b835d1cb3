// Additional layouts and shaders for pipelines of scenes with shadows, created when the first such pipeline is needed.
#pragma once

#include <span>

#include "engine/vulkan/descriptor_sets.h"

namespace simvis {

struct ShadowPipelines {
  /// `mesh_sets`: the set layouts of all mesh pipelines, see Pipelines.
  ShadowPipelines(DeviceImpl& device, std::span<const VkDescriptorSetLayout> mesh_sets);

  DescriptorLayout set_layout;              ///< SIMVIS_SHADOW_SET
  Handle<VkPipelineLayout> layout;          ///< the layout of all meshes, followed by this set
  Handle<VkShaderModule> map_frag;          ///< depth of opaque surfaces in a shadow map
  Handle<VkShaderModule> map_mask_frag[2];  ///< depth of masked surfaces, without and with a texture
  Handle<VkShaderModule> color_frag[3];     ///< colour with shadows, without a texture, with a texture, with maps
  Handle<VkShaderModule> layer_frag[3];     ///< as color_frag, for transparent surfaces
};

}  // namespace simvis
