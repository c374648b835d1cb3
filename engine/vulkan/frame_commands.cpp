#include "engine/vulkan/frame_commands.h"

#include <chrono>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/decimal.h"
#include "engine/vulkan/fence_wait.h"
#include "engine/vulkan/vulkan_check.h"

namespace simvis {

FrameCommands::FrameCommands(DeviceImpl& device, std::string purpose) : device_(device), purpose_(std::move(purpose)) {
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
  const bool gave_up = device_.shared->given_up();  // then its wait is over, and only asks
  const VkResult waited =
      wait_for_fence(device_.device, fence_.get(), gave_up ? std::chrono::nanoseconds(0) : device_.max_wait);
  if (waited == VK_SUCCESS) {
    end_submission();
    return;
  }
  give_up(waited, "vkWaitForFences");
  if (in_flight_) device_.shared->unfinished().add(fence_.get());
}

// The queue of a lost device uses nothing any more. After all other results the submission may still run.
void FrameCommands::give_up(VkResult result, const char* call) {
  std::string purpose = purpose_ + " on " + device_.physical.info.name;
  if (result == VK_TIMEOUT) {
    const double limit_s = std::chrono::duration<double>(device_.max_wait).count();
    purpose += " has not ended within " + decimal(limit_s, 6) + " s (SIMVIS_MAX_WAIT_S)";
  }
  device_.shared->give_up(result, call, purpose);
  if (result == VK_ERROR_DEVICE_LOST && in_flight_) end_submission();
}

void FrameCommands::end_submission() {
  in_flight_ = false;
  device_.finished = device_.submitted;
  device_.destroy_retired();
}

VkCommandBuffer FrameCommands::begin() {
  device_.shared->require_usable();
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
  const VkResult submitted = device_.shared->submit(info, fence);
  if (submitted == VK_ERROR_DEVICE_LOST) {
    give_up(submitted, "vkQueueSubmit");
    device_.shared->require_usable();
  }
  vk_check(submitted, "vkQueueSubmit", purpose_);
  ++device_.submitted;
  device_.recording = false;
  in_flight_ = true;
}

void FrameCommands::wait() {
  SIMVIS_ASSERT(in_flight_);
  const VkResult waited = wait_for_fence(device_.device, fence_.get(), device_.max_wait);
  if (waited == VK_SUCCESS) return end_submission();
  give_up(waited, "vkWaitForFences");
  device_.shared->require_usable();
}

void FrameCommands::abandon() { device_.recording = false; }

}  // namespace simvis
