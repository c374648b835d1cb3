#include "engine/render/item_shaders.h"

#include "engine/vulkan/pipeline_parts.h"
#include "shaders/mesh_item.frag.h"
#include "shaders/mesh_item.vert.h"
#include "shaders/mesh_item_mask.frag.h"
#include "shaders/mesh_item_mask.vert.h"
#include "shaders/mesh_item_mask_textured.frag.h"
#include "shaders/mesh_mask_instance.frag.h"
#include "shaders/mesh_mask_instance.vert.h"
#include "shaders/mesh_mask_instance_textured.frag.h"

namespace simvis {

ItemShaders::ItemShaders(DeviceImpl& device)
    : vert(make_module(device, mesh_item_vert, "mesh_item.vert")),
      frag(make_module(device, mesh_item_frag, "mesh_item.frag")),
      mask_vert(make_module(device, mesh_item_mask_vert, "mesh_item_mask.vert")),
      mask_frag{make_module(device, mesh_item_mask_frag, "mesh_item_mask.frag"),
                make_module(device, mesh_item_mask_textured_frag, "mesh_item_mask_textured.frag")},
      instance_vert(make_module(device, mesh_mask_instance_vert, "mesh_mask_instance.vert")),
      instance_frag{make_module(device, mesh_mask_instance_frag, "mesh_mask_instance.frag"),
                    make_module(device, mesh_mask_instance_textured_frag, "mesh_mask_instance_textured.frag")} {}

}  // namespace simvis
