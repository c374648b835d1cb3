// A buffer of vec4 that shaders fetch as texels.
#pragma once

#include "engine/vulkan/buffer.h"

namespace simvis {

inline constexpr VkDeviceSize kTexelBytes = 4 * sizeof(float);

/// A view of the whole buffer, as texels of four floats. Throws MachineError if the device allows fewer texels.
Handle<VkBufferView> make_texel_view(DeviceImpl& device, const Buffer& buffer);

}  // namespace simvis
