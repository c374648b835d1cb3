// The shaders of passes that read back items.
#pragma once

#include <cstdint>

#include "engine/vulkan/handle.h"

namespace simvis {

/// The vertex buffer binding of the instances' items; the other bindings are as in passes without items.
inline constexpr std::uint32_t kItemBinding = 3;

/// Made when a plan first has items.
struct ItemShaders {
  explicit ItemShaders(DeviceImpl& device);

  Handle<VkShaderModule> vert, frag;    ///< of opaque surfaces
  Handle<VkShaderModule> mask_vert;     ///< of masked surfaces
  Handle<VkShaderModule> mask_frag[2];  ///< without and with a texture
  /// Of masked surfaces in a pass of colour, whose alpha holds the instance; without and with a texture.
  Handle<VkShaderModule> instance_vert, instance_frag[2];
};

}  // namespace simvis
