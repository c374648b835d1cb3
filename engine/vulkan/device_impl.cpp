#include "engine/vulkan/device_impl.h"

#include <algorithm>
#include <cstdlib>
#include <mutex>
#include <shared_mutex>
#include <string>
#include <utility>

#include <simvis/error.h>
#include "engine/base/assert.h"
#include "engine/base/cache_file.h"
#include "engine/base/thread_pool.h"
#include "engine/vulkan/vulkan_check.h"

namespace simvis {
namespace {

void destroy_device(VkDevice device) {
  const std::unique_lock lock(loader_lists());
  vkDestroyDevice(device, nullptr);
}

constexpr VkMemoryPropertyFlags kLocal = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
constexpr VkMemoryPropertyFlags kMapped = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
constexpr VkMemoryPropertyFlags kCached = VK_MEMORY_PROPERTY_HOST_CACHED_BIT;

}  // namespace

bool wants_validation(const DeviceDesc& desc) {
  const char* environment = std::getenv("SIMVIS_VALIDATION");
  return desc.validation || (environment && std::string_view(environment) == "1");
}

DeviceImpl::DeviceImpl(const DeviceDesc& desc, unsigned pool_size)
    : DeviceImpl(find_device(wants_validation(desc), desc.select, bundled_driver()), desc, pool_size) {}

DeviceImpl::DeviceImpl(FoundDevice found, const DeviceDesc& desc, unsigned pool_size)
    : instance(std::move(found.instance)),
      physical(std::move(found.physical)),
      cache_folder(simvis::cache_folder(desc.cache_dir)),
      threads(shared_thread_pool(pool_size)),
      progress(desc.progress),
      instrumented(desc.instrumented) {
  vkGetPhysicalDeviceMemoryProperties(physical.handle, &memory);
  create_device();
  device_memory.emplace(device, memory, limits());
  choose_upload();
  try {
    pipeline_cache.emplace(device, physical.properties, cache_folder);
  } catch (...) {
    destroy_device(device);
    throw;
  }
}

DeviceImpl::~DeviceImpl() {
  vkDeviceWaitIdle(device);  // A lost device has nothing left to wait for.
  finished = ++submitted;
  destroy_retired();
  SIMVIS_ASSERT(live_objects_ == 0);
  pipeline_cache->save();
  pipeline_cache.reset();
  destroy_device(device);
}

void DeviceImpl::create_device() {
  const float priority = 1;
  const VkDeviceQueueCreateInfo queue_info{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                           .pNext = nullptr,
                                           .flags = 0,
                                           .queueFamilyIndex = physical.queue_family,
                                           .queueCount = 1,
                                           .pQueuePriorities = &priority};
  VkPhysicalDeviceFeatures features{};
  features.fullDrawIndexUint32 = VK_TRUE;
  features.pipelineStatisticsQuery = instrumented && physical.counts_invocations;
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
  if (physical.max_draws > 1) {
    info.pNext = &multi_draw;
    info.enabledExtensionCount = 1;
    info.ppEnabledExtensionNames = &extension;
  }
  {
    const std::unique_lock lock(loader_lists());
    vk_check(vkCreateDevice(physical.handle, &info, nullptr, &device), "vkCreateDevice");
  }
  vkGetDeviceQueue(device, physical.queue_family, 0, &queue);
  if (physical.max_draws > 1) {
    draw_many_ =
        reinterpret_cast<PFN_vkCmdDrawMultiIndexedEXT>(vkGetDeviceProcAddr(device, "vkCmdDrawMultiIndexedEXT"));
  }
  if (!instance->validation()) return;
  set_name_ =
      reinterpret_cast<PFN_vkSetDebugUtilsObjectNameEXT>(vkGetDeviceProcAddr(device, "vkSetDebugUtilsObjectNameEXT"));
  begin_label_ =
      reinterpret_cast<PFN_vkCmdBeginDebugUtilsLabelEXT>(vkGetDeviceProcAddr(device, "vkCmdBeginDebugUtilsLabelEXT"));
  end_label_ =
      reinterpret_cast<PFN_vkCmdEndDebugUtilsLabelEXT>(vkGetDeviceProcAddr(device, "vkCmdEndDebugUtilsLabelEXT"));
}

void DeviceImpl::choose_upload() {
  // A small host-visible part of the device's memory is not enough, because geometry may not fit into it.
  VkDeviceSize largest = 0, visible = 0;
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i) {
    if (memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) {
      largest = std::max(largest, memory.memoryHeaps[i].size);
    }
  }
  for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
    if ((memory.memoryTypes[i].propertyFlags & (kLocal | kMapped)) == (kLocal | kMapped)) {
      visible = std::max(visible, memory.memoryHeaps[memory.memoryTypes[i].heapIndex].size);
    }
  }
  direct_upload = visible > 0 && visible == largest;
}

std::uint32_t DeviceImpl::memory_type(std::uint32_t allowed_types, MemoryKind kind) const {
  VkMemoryPropertyFlags wanted = 0, needed = 0;
  switch (kind) {
    case MemoryKind::device:
      wanted = needed = direct_upload ? kLocal | kMapped : kLocal;
      break;
    case MemoryKind::image:
      wanted = kLocal;
      break;
    case MemoryKind::dynamic:
      wanted = kLocal | kMapped;
      needed = kMapped;
      break;
    case MemoryKind::staging:
      wanted = needed = kMapped;
      break;
    case MemoryKind::readback:
      wanted = kCached | kMapped;
      needed = kMapped;
      break;
  }
  for (const VkMemoryPropertyFlags flags : {wanted, needed}) {
    for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
      const bool allowed = (allowed_types >> i) & 1u;
      if (allowed && (memory.memoryTypes[i].propertyFlags & flags) == flags) return i;
    }
  }
  throw MachineError("no memory type of " + physical.info.name + " has the required properties");
}

void DeviceImpl::adopt(VkObjectType type, std::uint64_t handle, std::string_view name) {
  ++live_objects_;
  if (!set_name_) return;
  const std::string text(name);
  const VkDebugUtilsObjectNameInfoEXT info{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT,
                                           .pNext = nullptr,
                                           .objectType = type,
                                           .objectHandle = handle,
                                           .pObjectName = text.c_str()};
  const std::shared_lock lock(loader_lists());
  set_name_(device, &info);
}

void DeviceImpl::retire(std::function<void()> destroy) {
  const std::uint64_t serial = recording ? submitted + 1 : submitted;
  retired_.push_back({std::move(destroy), serial});
  if (serial <= finished) destroy_retired();
}

void DeviceImpl::destroy_retired() {
  while (!retired_.empty() && retired_.front().serial <= finished) {
    retired_.front().destroy();
    retired_.pop_front();
    --live_objects_;
  }
}

void DeviceImpl::begin_label(VkCommandBuffer commands, std::string_view name) const {
  if (!begin_label_) return;
  const std::string text(name);
  const VkDebugUtilsLabelEXT label{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT,
                                   .pNext = nullptr,
                                   .pLabelName = text.c_str(),
                                   .color = {0, 0, 0, 0}};
  begin_label_(commands, &label);
}

void DeviceImpl::end_label(VkCommandBuffer commands) const {
  if (end_label_) end_label_(commands);
}

void DeviceImpl::draw_indexed(VkCommandBuffer commands, std::span<const VkMultiDrawIndexedInfoEXT> draws,
                              std::uint32_t instance_count, std::uint32_t first_instance) const {
  if (physical.max_draws == 1 || draws.size() == 1) {
    for (const VkMultiDrawIndexedInfoEXT& d : draws) {
      vkCmdDrawIndexed(commands, d.indexCount, instance_count, d.firstIndex, d.vertexOffset, first_instance);
    }
    return;
  }
  for (std::size_t first = 0; first < draws.size(); first += physical.max_draws) {
    const std::size_t count = std::min<std::size_t>(physical.max_draws, draws.size() - first);
    draw_many_(commands, static_cast<std::uint32_t>(count), &draws[first], instance_count, first_instance,
               sizeof draws[0], nullptr);
  }
}

}  // namespace simvis
