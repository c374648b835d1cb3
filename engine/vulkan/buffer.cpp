#include "engine/vulkan/buffer.h"

#include "engine/base/assert.h"
#include "engine/vulkan/vulkan_check.h"

namespace simvis {

Buffer::Buffer(DeviceImpl& device, BufferDesc desc) : desc_(std::move(desc)) {
  SIMVIS_ASSERT(desc_.size > 0 && !desc_.name.empty());
  const VkBufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                .pNext = nullptr,
                                .flags = 0,
                                .size = desc_.size,
                                .usage = desc_.usage,
                                .sharingMode = VK_SHARING_MODE_EXCLUSIVE,
                                .queueFamilyIndexCount = 0,
                                .pQueueFamilyIndices = nullptr};
  VkBuffer buffer = VK_NULL_HANDLE;
  vk_check(vkCreateBuffer(device.device, &info, nullptr, &buffer), "vkCreateBuffer",
           std::to_string(desc_.size) + " bytes for \"" + desc_.name + "\"");
  buffer_ = Handle<VkBuffer>(device, buffer, desc_.name);
  memory_ = MemorySlice(device, buffer, desc_.memory, desc_.name);
}

}  // namespace simvis
