#include "engine/vulkan/sharing/unfinished_work.h"

#include <utility>

namespace simvis {

void UnfinishedWork::add(VkFence fence) {
  const std::lock_guard lock(mutex_);
  fences_.push_back(fence);
}

void UnfinishedWork::keep(std::vector<Retired> objects, std::unique_ptr<DeviceMemory> memory) {
  const std::lock_guard lock(mutex_);
  kept_.push_back({.memory = std::move(memory), .objects = std::move(objects)});
}

bool UnfinishedWork::any() {
  const std::lock_guard lock(mutex_);
  std::erase_if(fences_, [this](VkFence fence) {
    const VkResult status = vkGetFenceStatus(device_, fence);
    return status == VK_SUCCESS || status == VK_ERROR_DEVICE_LOST;
  });
  return !fences_.empty();
}

void UnfinishedWork::destroy() {
  const std::lock_guard lock(mutex_);
  for (const Kept& kept : kept_) {
    for (const Retired& object : kept.objects) object.destroy();
  }
  kept_.clear();
}

}  // namespace simvis
