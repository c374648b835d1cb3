#include "tests/fault_layer/memory_model.h"

#include <cstdio>
#include <cstdlib>
#include <iterator>

namespace simvis::faults {
namespace {

[[noreturn]] void refuse(const char* what) {
  std::fprintf(stderr, "VK_LAYER_SIMVIS_faults: %s\n", what);
  std::abort();
}

std::uint32_t type_with(const VkPhysicalDeviceMemoryProperties& driver, VkMemoryPropertyFlags flags) {
  for (std::uint32_t i = 0; i < driver.memoryTypeCount; ++i) {
    if ((driver.memoryTypes[i].propertyFlags & flags) == flags) return i;
  }
  refuse("SIMVIS_FAULT_MEMORY_TYPES: the driver has no memory type with these properties");
}

}  // namespace

void set_limits(const std::vector<Limit>& wanted, VkPhysicalDeviceLimits& limits) {
  for (const Limit& limit : wanted) {
    bool known = false;
#define SIMVIS_LIMIT(member)                                           \
  if (limit.name == #member) {                                         \
    limits.member = static_cast<decltype(limits.member)>(limit.value); \
    known = true;                                                      \
  }
#include "tests/fault_layer/limits.inc"
#undef SIMVIS_LIMIT
    if (!known) refuse("SIMVIS_FAULT_LIMITS: there is no such limit");
  }
}

MemoryModel::MemoryModel(const Settings& settings, const VkPhysicalDeviceMemoryProperties& driver,
                         VkPhysicalDeviceLimits limits)
    : shown_(driver), limits_heaps_(!settings.heap_size.empty()) {
  set_limits(settings.limits, limits);
  max_allocations_ = limits.maxMemoryAllocationCount;
  if (!settings.types.empty()) {
    shown_.memoryTypeCount = static_cast<std::uint32_t>(settings.types.size());
    shown_.memoryHeapCount = static_cast<std::uint32_t>(settings.heap_size.size());
    for (VkMemoryHeap& heap : shown_.memoryHeaps) heap.flags = 0;
    if (settings.types.size() > std::size(shown_.memoryTypes)) refuse("SIMVIS_FAULT_MEMORY_TYPES: too many types");
    for (std::size_t i = 0; i < settings.types.size(); ++i) {
      const MemoryType& type = settings.types[i];
      types_.push_back(type_with(driver, type.flags));
      shown_.memoryTypes[i] = {type.flags, type.heap};
      if (type.flags & VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT) {
        shown_.memoryHeaps[type.heap].flags = VK_MEMORY_HEAP_DEVICE_LOCAL_BIT;
      }
    }
  }
  if (settings.heap_size.size() > shown_.memoryHeapCount) refuse("SIMVIS_FAULT_HEAPS: more heaps than the driver has");
  for (std::size_t i = 0; i < settings.heap_size.size(); ++i) shown_.memoryHeaps[i].size = settings.heap_size[i];
}

std::uint32_t MemoryModel::shown_types(std::uint32_t driver_types) const {
  if (types_.empty()) return driver_types;
  std::uint32_t result = 0;
  for (std::size_t i = 0; i < types_.size(); ++i) result |= (driver_types >> types_[i] & 1u) << i;
  return result;
}

std::optional<VkResult> MemoryModel::reserve(const VkMemoryAllocateInfo& info) {
  const std::lock_guard lock(mutex_);
  if (allocations_ >= max_allocations_) return VK_ERROR_TOO_MANY_OBJECTS;
  VkDeviceSize& used = used_[heap_of(info)];
  const VkDeviceSize size = shown_.memoryHeaps[heap_of(info)].size;
  if (limits_heaps_ && (info.allocationSize > size || used > size - info.allocationSize)) {
    return VK_ERROR_OUT_OF_DEVICE_MEMORY;
  }
  used += info.allocationSize;
  ++allocations_;
  return std::nullopt;
}

void MemoryModel::give_back(const VkMemoryAllocateInfo& info) {
  const std::lock_guard lock(mutex_);
  used_[heap_of(info)] -= info.allocationSize;
  --allocations_;
}

void MemoryModel::note(VkDeviceMemory memory, const VkMemoryAllocateInfo& info) {
  const std::lock_guard lock(mutex_);
  held_[memory] = info;
}

void MemoryModel::freed(VkDeviceMemory memory) {
  VkMemoryAllocateInfo info{};
  {
    const std::lock_guard lock(mutex_);
    const auto found = held_.find(memory);
    if (found == held_.end()) return;
    info = found->second;
    held_.erase(found);
  }
  give_back(info);
}

bool MemoryModel::can_map(VkDeviceMemory memory) const {
  const std::lock_guard lock(mutex_);
  const auto found = held_.find(memory);
  return found != held_.end() &&
         (shown_.memoryTypes[found->second.memoryTypeIndex].propertyFlags & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT) != 0;
}

}  // namespace simvis::faults
