#include "engine/vulkan/texel_buffer.h"

#include <string>

#include <simvis/error.h>
#include "engine/vulkan/vulkan_check.h"

namespace simvis {

Handle<VkBufferView> make_texel_view(DeviceImpl& device, const Buffer& buffer) {
  const VkDeviceSize texels = buffer.size() / kTexelBytes, limit = device.limits().maxTexelBufferElements;
  if (texels > limit) {
    throw MachineError("a frame needs " + std::to_string(texels) + " texels of " + buffer.desc().name + "; " +
                       device.physical.info.name + " allows " + std::to_string(limit));
  }
  const VkBufferViewCreateInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO,
                                    .pNext = nullptr,
                                    .flags = 0,
                                    .buffer = buffer.get(),
                                    .format = VK_FORMAT_R32G32B32A32_SFLOAT,
                                    .offset = 0,
                                    .range = texels * kTexelBytes};
  VkBufferView view = VK_NULL_HANDLE;
  vk_check(vkCreateBufferView(device.device, &info, nullptr, &view), "vkCreateBufferView");
  return {device, view, buffer.desc().name};
}

}  // namespace simvis
