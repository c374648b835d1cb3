#include "engine/vulkan/frame_commands.h"

#include "engine/base/assert.h"
#include "engine/vulkan/vulkan_check.h"

namespace simvis {

FrameCommands::FrameCommands(DeviceImpl& device) : device_(device) {
  const VkCommandPoolCreateInfo pool_info{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                          .pNext = nullptr,
                                          .flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT,
                                          .queueFamilyIndex = device.physical.queue_family};
  VkCommandPool pool = VK_NULL_HANDLE;
  vk_check(vkCreateCommandPool(device.device, &pool_info, nullptr, &pool), "vkCreateCommandPool");
  pool_ = Handle<VkCommandPool>(device, pool, "frame commands");
  const VkCommandBufferAllocateInfo buffer_info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                                .pNext = nullptr,
                                                .commandPool = pool,
                                                .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                                .commandBufferCount = 1};
  vk_check(vkAllocateCommandBuffers(device.device, &buffer_info, &commands_), "vkAllocateCommandBuffers");
  const VkFenceCreateInfo fence_info{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO, .pNext = nullptr, .flags = 0};
  VkFence fence = VK_NULL_HANDLE;
  vk_check(vkCreateFence(device.device, &fence_info, nullptr, &fence), "vkCreateFence");
  fence_ = Handle<VkFence>(device, fence, "frame fence");
}

FrameCommands::~FrameCommands() {
  if (!in_flight_) return;
  const VkFence fence = fence_.get();
  vkWaitForFences(device_.device, 1, &fence, VK_TRUE, UINT64_MAX);  // a lost device has finished too
  device_.finished = device_.submitted;
  device_.destroy_retired();
}

VkCommandBuffer FrameCommands::begin() {
  SIMVIS_ASSERT(!device_.recording && device_.submitted == device_.finished);
  vk_check(vkResetCommandPool(device_.device, pool_.get(), 0), "vkResetCommandPool");
  const VkCommandBufferBeginInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                      .pNext = nullptr,
                                      .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT,
                                      .pInheritanceInfo = nullptr};
  vk_check(vkBeginCommandBuffer(commands_, &info), "vkBeginCommandBuffer");
  device_.recording = true;
  return commands_;
}

void FrameCommands::submit() {
  vk_check(vkEndCommandBuffer(commands_), "vkEndCommandBuffer");
  VkSubmitInfo info{};
  info.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
  info.commandBufferCount = 1;
  info.pCommandBuffers = &commands_;
  VkFence fence = fence_.get();
  vk_check(vkResetFences(device_.device, 1, &fence), "vkResetFences");
  vk_check(device_.shared->submit(info, fence), "vkQueueSubmit");
  ++device_.submitted;
  device_.recording = false;
  in_flight_ = true;
}

void FrameCommands::wait() {
  SIMVIS_ASSERT(in_flight_);
  const VkFence fence = fence_.get();
  in_flight_ = false;
  const VkResult waited = vkWaitForFences(device_.device, 1, &fence, VK_TRUE, UINT64_MAX);
  device_.finished = device_.submitted;  // A lost device has finished too.
  vk_check(waited, "vkWaitForFences");
  device_.destroy_retired();
}

void FrameCommands::abandon() { device_.recording = false; }

}  // namespace simvis
