#include "engine/vulkan/memory_slice.h"

#include <utility>

#include "engine/vulkan/vulkan_check.h"

namespace simvis {
namespace {

struct Requirements {
  VkMemoryDedicatedRequirements dedicated{.sType = VK_STRUCTURE_TYPE_MEMORY_DEDICATED_REQUIREMENTS,
                                          .pNext = nullptr,
                                          .prefersDedicatedAllocation = VK_FALSE,
                                          .requiresDedicatedAllocation = VK_FALSE};
  VkMemoryRequirements2 all{
      .sType = VK_STRUCTURE_TYPE_MEMORY_REQUIREMENTS_2, .pNext = &dedicated, .memoryRequirements = {}};

  MemoryRequest request(std::string_view name) const {
    return {.name = name,
            .needs = all.memoryRequirements,
            .requires_own = dedicated.requiresDedicatedAllocation == VK_TRUE,
            .prefers_own = dedicated.prefersDedicatedAllocation == VK_TRUE};
  }
};

}  // namespace

MemorySlice::MemorySlice(DeviceImpl& device, VkBuffer buffer, MemoryKind kind, std::string_view name) : MemorySlice() {
  device_ = &device;
  const VkBufferMemoryRequirementsInfo2 info{
      .sType = VK_STRUCTURE_TYPE_BUFFER_MEMORY_REQUIREMENTS_INFO_2, .pNext = nullptr, .buffer = buffer};
  Requirements requirements;
  vkGetBufferMemoryRequirements2(device.device, &info, &requirements.all);
  MemoryRequest request = requirements.request(name);
  request.type = device.memory_type(request.needs.memoryTypeBits, kind);
  request.mapped = kind != MemoryKind::device || device.direct_upload;
  request.buffer = buffer;
  take(request);
  vk_check(vkBindBufferMemory(device.device, buffer, range_->memory, range_->offset), "vkBindBufferMemory", name);
}

MemorySlice::MemorySlice(DeviceImpl& device, VkImage image, MemoryKind kind, std::string_view name) : MemorySlice() {
  device_ = &device;
  const VkImageMemoryRequirementsInfo2 info{
      .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_REQUIREMENTS_INFO_2, .pNext = nullptr, .image = image};
  Requirements requirements;
  vkGetImageMemoryRequirements2(device.device, &info, &requirements.all);
  MemoryRequest request = requirements.request(name);
  request.type = device.memory_type(request.needs.memoryTypeBits, kind);
  request.mapped = kind == MemoryKind::readback;
  request.image = image;
  take(request);
  vk_check(vkBindImageMemory(device.device, image, range_->memory, range_->offset), "vkBindImageMemory", name);
}

void MemorySlice::take(const MemoryRequest& request) {
  auto range = std::make_unique<MemoryRange>();
  device_->adopt_memory();
  try {
    *range = device_->device_memory->take(request);
  } catch (...) {
    device_->disown_memory();
    throw;
  }
  range_ = std::move(range);
  held_ = MemoryLedger(device_->memory_bytes, request.needs.size);
}

void MemorySlice::retire() {
  if (range_ == nullptr) return;
  device_->retire([&memory = *device_->device_memory, range = range_.release()] {
    const std::unique_ptr<MemoryRange> owned(range);
    memory.give_back(*owned);
  });
}

}  // namespace simvis
