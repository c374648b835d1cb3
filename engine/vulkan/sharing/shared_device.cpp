#include "engine/vulkan/sharing/shared_device.h"

#include <shared_mutex>
#include <utility>

#include <simvis/error.h>
#include "engine/vulkan/vulkan_check.h"

namespace simvis {
namespace {

void destroy_device(VkDevice device) {
  const std::unique_lock lock(loader_lists());
  vkDestroyDevice(device, nullptr);
}

}  // namespace

SharedDevice::SharedDevice(FoundDevice found, const DeviceChoice& choice)
    : instance_(std::move(found.instance)), physical_(std::move(found.physical)), choice_(choice) {
  create();
  try {
    pipeline_cache_ = std::make_unique<PipelineCache>(device_, physical_.properties, choice.cache_folder);
    unfinished_.emplace(device_);
  } catch (...) {
    destroy_device(device_);
    throw;
  }
}

SharedDevice::~SharedDevice() {
  unfinished_->destroy();
  if (!given_up_) pipeline_cache_->save();
  pipeline_cache_.reset();
  destroy_device(device_);
}

void SharedDevice::create() {
  const float priority = 1;
  const VkDeviceQueueCreateInfo queue_info{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                           .pNext = nullptr,
                                           .flags = 0,
                                           .queueFamilyIndex = physical_.queue_family,
                                           .queueCount = 1,
                                           .pQueuePriorities = &priority};
  VkPhysicalDeviceFeatures features{};
  features.fullDrawIndexUint32 = VK_TRUE;
  features.pipelineStatisticsQuery = choice_.instrumented && physical_.counts_invocations;
  features.largePoints = physical_.has_large_points;
  features.fragmentStoresAndAtomics = VK_TRUE;
  features.sampleRateShading = VK_TRUE;
  VkDeviceCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queue_info;
  info.pEnabledFeatures = &features;
  VkPhysicalDeviceMultiDrawFeaturesEXT multi_draw{};
  multi_draw.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MULTI_DRAW_FEATURES_EXT;
  multi_draw.multiDraw = VK_TRUE;
  const char* const extension = VK_EXT_MULTI_DRAW_EXTENSION_NAME;
  if (physical_.max_draws > 1) {
    info.pNext = &multi_draw;
    info.enabledExtensionCount = 1;
    info.ppEnabledExtensionNames = &extension;
  }
  {
    const std::unique_lock lock(loader_lists());
    vk_check(vkCreateDevice(physical_.handle, &info, nullptr, &device_), "vkCreateDevice");
  }
  vkGetDeviceQueue(device_, physical_.queue_family, 0, &queue_);
  if (physical_.max_draws > 1) draw_many_ = function<PFN_vkCmdDrawMultiIndexedEXT>("vkCmdDrawMultiIndexedEXT");
  if (!instance_->validation()) return;
  set_name_ = function<PFN_vkSetDebugUtilsObjectNameEXT>("vkSetDebugUtilsObjectNameEXT");
  begin_label_ = function<PFN_vkCmdBeginDebugUtilsLabelEXT>("vkCmdBeginDebugUtilsLabelEXT");
  end_label_ = function<PFN_vkCmdEndDebugUtilsLabelEXT>("vkCmdEndDebugUtilsLabelEXT");
}

VkResult SharedDevice::submit(const VkSubmitInfo& info, VkFence fence) {
  const std::lock_guard lock(submitting_);
  return vkQueueSubmit(queue_, 1, &info, fence);
}

void SharedDevice::give_up(VkResult result, const char* call, std::string_view purpose) {
  {
    const std::lock_guard lock(reason_mutex_);
    if (reason_.empty()) reason_ = result_message(result, call, purpose);
  }
  given_up_ = true;
  if (result != VK_ERROR_DEVICE_LOST) return;
  // Vulkan (Lost Device): this returns in finite time, and afterwards nothing counts as in use. The queue of a driver
  // that reports a loss too early has then ended as well.
  const std::lock_guard lock(submitting_);
  vkDeviceWaitIdle(device_);
}

void SharedDevice::require_usable() const {
  if (!given_up_) return;
  const std::lock_guard lock(reason_mutex_);
  throw MachineError(reason_ + "; this device was given up: a simulation that is loaded again gets a new one");
}

void SharedDevice::check(VkResult result, const char* call, std::string_view purpose) {
  if (result == VK_ERROR_DEVICE_LOST) {
    give_up(result, call, purpose);
    require_usable();
  }
  vk_check(result, call, purpose);
}

void SharedDevice::name(VkObjectType type, std::uint64_t handle, std::string_view name) const {
  if (!set_name_) return;
  const std::string text(name);
  const VkDebugUtilsObjectNameInfoEXT info{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT,
                                           .pNext = nullptr,
                                           .objectType = type,
                                           .objectHandle = handle,
                                           .pObjectName = text.c_str()};
  const std::shared_lock lock(loader_lists());
  set_name_(device_, &info);
}

void SharedDevice::begin_label(VkCommandBuffer commands, std::string_view name) const {
  if (!begin_label_) return;
  const std::string text(name);
  const VkDebugUtilsLabelEXT label{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT,
                                   .pNext = nullptr,
                                   .pLabelName = text.c_str(),
                                   .color = {0, 0, 0, 0}};
  begin_label_(commands, &label);
}

void SharedDevice::end_label(VkCommandBuffer commands) const {
  if (end_label_) end_label_(commands);
}

}  // namespace simvis
