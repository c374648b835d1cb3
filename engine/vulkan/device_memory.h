// The device's memory: a few large allocations from which buffers and images get ranges.
#pragma once

#include <vulkan/vulkan.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/base/free_ranges.h"

namespace simvis {

/// The memory request of one buffer or image.
struct MemoryRequest {
  std::string_view name;  ///< name of the resource, for messages
  VkMemoryRequirements needs{};
  std::uint32_t type = 0;                          ///< one of needs.memoryTypeBits
  bool mapped = false;                             ///< the host reads or writes it
  bool requires_own = false, prefers_own = false;  ///< whether the device needs or prefers a dedicated allocation
  VkBuffer buffer = VK_NULL_HANDLE;                ///< null for an image
  VkImage image = VK_NULL_HANDLE;                  ///< the other is null
};

struct MemoryBlock;

/// A range of one allocation. It belongs to one buffer or image.
struct MemoryRange {
  MemoryBlock* block = nullptr;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  VkDeviceSize offset = 0, size = 0;
  std::byte* mapped = nullptr;  ///< null unless the request asked for mapped memory
};

/// The Vulkan calls that allocate, free and map memory. Tests replace them.
struct MemoryCalls {
  PFN_vkAllocateMemory allocate;
  PFN_vkFreeMemory free;
  PFN_vkMapMemory map;
};

/// Many GPUs allow no more than 4,096 allocations, and each one is slow. Memory is therefore allocated in blocks, which
/// grow with what is already held: from 1 MiB to 64 MiB, and to at most a 64th of the heap. A resource that would fill
/// more than half of a block gets an allocation of exactly its size, and so does one for which the device asks for
/// that. A block goes back to the device as soon as it is empty. It is mapped from the first request for mapped memory
/// until then.
///
/// Images never share a block with buffers: their distance always satisfies bufferImageGranularity. Ranges begin at
/// multiples of kHostAlignment.
///
/// Not synchronised. Like everything in DeviceImpl it is used by one thread at a time.
class DeviceMemory {
 public:
  /// Vulkan guarantees this alignment for mapped allocations (minMemoryMapAlignment); it is also a cache line.
  static constexpr VkDeviceSize kHostAlignment = 64;

  DeviceMemory(VkDevice device, const VkPhysicalDeviceMemoryProperties& memory, const VkPhysicalDeviceLimits& limits);
  DeviceMemory(VkDevice device, const VkPhysicalDeviceMemoryProperties& memory, const VkPhysicalDeviceLimits& limits,
               const MemoryCalls& calls);
  /// All ranges must have been given back.
  ~DeviceMemory();
  DeviceMemory(const DeviceMemory&) = delete;
  DeviceMemory& operator=(const DeviceMemory&) = delete;

  /// Throws MachineError, whose message holds Vulkan's result and the request, when the heap is exhausted or the device
  /// allows no further allocation.
  MemoryRange take(const MemoryRequest& request);
  void give_back(const MemoryRange& range);

  std::uint64_t allocations() const { return allocations_; }  ///< number of allocations held
  std::uint64_t bytes() const { return bytes_; }              ///< size of these allocations

 private:
  // Blocks of one memory type for one kind of resource, the oldest first.
  struct Pool {
    std::vector<std::unique_ptr<MemoryBlock>> blocks;
    VkDeviceSize bytes = 0;
  };
  VkDeviceSize block_size(const Pool& pool, std::uint32_t type) const;
  VkDeviceSize step(std::uint32_t type) const;
  MemoryRange cut(Pool& pool, const MemoryRequest& request);
  MemoryBlock& add_block(Pool& pool, const MemoryRequest& request);
  VkResult allocate(Pool& pool, const MemoryRequest& request, VkDeviceSize size, bool own);
  void check(VkResult result, const MemoryRequest& request) const;
  void free_if_empty(MemoryBlock& block);
  bool gets_own(const MemoryRequest& request) const;

  VkDevice device_;
  VkPhysicalDeviceMemoryProperties memory_;
  VkDeviceSize non_coherent_atom_;
  std::uint64_t max_allocations_;
  MemoryCalls calls_;
  std::map<std::pair<std::uint32_t, bool>, Pool> pools_;  // by memory type, and whether they hold images
  std::uint64_t allocations_ = 0, bytes_ = 0;
};

}  // namespace simvis
