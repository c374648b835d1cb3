#include "engine/vulkan/buffer.h"

#include "engine/base/assert.h"
#include "engine/vulkan/vulkan_check.h"

namespace simvis {

Buffer::Buffer(Device::Impl& device, BufferDesc desc) : desc_(std::move(desc)) {
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
  vk_check(vkCreateBuffer(device.device, &info, nullptr, &buffer), "vkCreateBuffer");
  buffer_ = Handle<VkBuffer>(device, buffer, desc_.name);

  VkMemoryRequirements needs;
  vkGetBufferMemoryRequirements(device.device, buffer, &needs);
  const VkMemoryAllocateInfo allocation{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                        .pNext = nullptr,
                                        .allocationSize = needs.size,
                                        .memoryTypeIndex = device.memory_type(needs.memoryTypeBits, desc_.memory)};
  VkDeviceMemory memory = VK_NULL_HANDLE;
  vk_check(vkAllocateMemory(device.device, &allocation, nullptr, &memory), "vkAllocateMemory");
  memory_ = Handle<VkDeviceMemory>(device, memory, desc_.name + " memory");
  held_ = MemoryLedger(device.memory_bytes, needs.size);
  vk_check(vkBindBufferMemory(device.device, buffer, memory, 0), "vkBindBufferMemory");

  const auto flags = device.memory.memoryTypes[allocation.memoryTypeIndex].propertyFlags;
  const bool wants_map = desc_.memory != MemoryKind::device || device.direct_upload;
  if (wants_map && (flags & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT)) {
    void* mapped = nullptr;
    vk_check(vkMapMemory(device.device, memory, 0, VK_WHOLE_SIZE, 0, &mapped), "vkMapMemory");
    mapped_ = static_cast<std::byte*>(mapped);
  }
}

}  // namespace simvis
