// The memory types, heaps and limits that the program sees, which may differ from the driver's.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include "tests/fault_layer/settings.h"

namespace simvis::faults {

void set_limits(const std::vector<Limit>& wanted, VkPhysicalDeviceLimits& limits);

/// Threads  any.
class MemoryModel {
 public:
  /// `driver` and `limits` are the driver's. Ends the program if the driver has no type for one of the settings.
  MemoryModel(const Settings& settings, const VkPhysicalDeviceMemoryProperties& driver, VkPhysicalDeviceLimits limits);

  const VkPhysicalDeviceMemoryProperties& properties() const { return shown_; }
  /// The bits of the types that the program sees, for the bits of the driver's types.
  std::uint32_t shown_types(std::uint32_t driver_types) const;
  /// The driver's type for one that the program sees.
  std::uint32_t driver_type(std::uint32_t shown_type) const { return types_.empty() ? shown_type : types_[shown_type]; }

  /// Empty if heap and count have room for it, which it then takes.
  std::optional<VkResult> reserve(const VkMemoryAllocateInfo& info);
  void give_back(const VkMemoryAllocateInfo& info);
  void note(VkDeviceMemory memory, const VkMemoryAllocateInfo& info);
  void freed(VkDeviceMemory memory);
  bool can_map(VkDeviceMemory memory) const;

 private:
  std::uint32_t heap_of(const VkMemoryAllocateInfo& info) const {
    return shown_.memoryTypes[info.memoryTypeIndex].heapIndex;
  }

  VkPhysicalDeviceMemoryProperties shown_;
  std::vector<std::uint32_t> types_;  // of the driver, by type that the program sees; empty: the same
  bool limits_heaps_;
  std::uint32_t max_allocations_;
  mutable std::mutex mutex_;
  VkDeviceSize used_[VK_MAX_MEMORY_HEAPS] = {};
  std::uint32_t allocations_ = 0;
  std::map<VkDeviceMemory, VkMemoryAllocateInfo> held_;
};

}  // namespace simvis::faults
