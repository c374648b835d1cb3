#include "engine/render/shadow_pipelines.h"

#include <vector>

#include "engine/vulkan/pipeline_parts.h"
#include "shaders/interop.h"
#include "shaders/mesh_color_mapped_shadowed.frag.h"
#include "shaders/mesh_color_shadowed.frag.h"
#include "shaders/mesh_color_textured_shadowed.frag.h"
#include "shaders/mesh_layer_mapped_shadowed.frag.h"
#include "shaders/mesh_layer_shadowed.frag.h"
#include "shaders/mesh_layer_textured_shadowed.frag.h"
#include "shaders/mesh_shadow.frag.h"
#include "shaders/mesh_shadow_mask.frag.h"
#include "shaders/mesh_shadow_mask_textured.frag.h"

namespace simvis {

ShadowPipelines::ShadowPipelines(DeviceImpl& device, std::span<const VkDescriptorSetLayout> mesh_sets)
    : map_frag(make_module(device, mesh_shadow_frag, "mesh_shadow.frag")),
      map_mask_frag{make_module(device, mesh_shadow_mask_frag, "mesh_shadow_mask.frag"),
                    make_module(device, mesh_shadow_mask_textured_frag, "mesh_shadow_mask_textured.frag")},
      color_frag{make_module(device, mesh_color_shadowed_frag, "mesh_color_shadowed.frag"),
                 make_module(device, mesh_color_textured_shadowed_frag, "mesh_color_textured_shadowed.frag"),
                 make_module(device, mesh_color_mapped_shadowed_frag, "mesh_color_mapped_shadowed.frag")},
      layer_frag{make_module(device, mesh_layer_shadowed_frag, "mesh_layer_shadowed.frag"),
                 make_module(device, mesh_layer_textured_shadowed_frag, "mesh_layer_textured_shadowed.frag"),
                 make_module(device, mesh_layer_mapped_shadowed_frag, "mesh_layer_mapped_shadowed.frag")} {
  const VkDescriptorSetLayoutBinding bindings[] = {
      descriptor_binding(SIMVIS_SHADOWS, VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, VK_SHADER_STAGE_FRAGMENT_BIT),
      descriptor_binding(SIMVIS_SHADOW_ATLAS, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, VK_SHADER_STAGE_FRAGMENT_BIT)};
  set_layout = DescriptorLayout(device, bindings, "shadow set layout");
  std::vector<VkDescriptorSetLayout> sets(mesh_sets.begin(), mesh_sets.end());
  sets.push_back(set_layout.get());
  layout = make_mesh_layout(device, sets, "mesh pipeline layout with shadows");
}

}  // namespace simvis
