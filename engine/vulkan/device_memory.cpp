#include "engine/vulkan/device_memory.h"

#include <algorithm>
#include <bit>
#include <optional>
#include <string>

#include "engine/base/assert.h"
#include "engine/vulkan/vulkan_check.h"

namespace simvis {
namespace {

constexpr VkDeviceSize kSmallestBlock = VkDeviceSize{1} << 20, kLargestBlock = VkDeviceSize{64} << 20;
constexpr VkDeviceSize kBlocksPerHeap = 64;
// A block larger than kSmallestBlock is at most 1 / kGrowth of the memory that the pool already holds. This bounds the
// idle memory.
constexpr VkDeviceSize kGrowth = 4;

VkDeviceSize round_up(VkDeviceSize size, VkDeviceSize step) { return (size + step - 1) / step * step; }

}  // namespace

struct MemoryBlock {
  std::pair<std::uint32_t, bool> pool;
  VkDeviceMemory memory;
  VkDeviceSize size;
  FreeRanges free;
  std::byte* mapped = nullptr;
};

DeviceMemory::DeviceMemory(VkDevice device, const VkPhysicalDeviceMemoryProperties& memory,
                           const VkPhysicalDeviceLimits& limits)
    : DeviceMemory(device, memory, limits, {.allocate = vkAllocateMemory, .free = vkFreeMemory, .map = vkMapMemory}) {}

DeviceMemory::DeviceMemory(VkDevice device, const VkPhysicalDeviceMemoryProperties& memory,
                           const VkPhysicalDeviceLimits& limits, const MemoryCalls& calls)
    : device_(device),
      memory_(memory),
      non_coherent_atom_(limits.nonCoherentAtomSize),
      max_allocations_(limits.maxMemoryAllocationCount),
      calls_(calls) {}

DeviceMemory::~DeviceMemory() { SIMVIS_ASSERT(allocations_ == 0 && bytes_ == 0); }

MemoryRange DeviceMemory::take(const MemoryRequest& request) {
  SIMVIS_ASSERT(request.needs.memoryTypeBits >> request.type & 1u);
  SIMVIS_ASSERT((request.buffer == VK_NULL_HANDLE) != (request.image == VK_NULL_HANDLE));
  Pool& pool = pools_[{request.type, request.image != VK_NULL_HANDLE}];
  MemoryRange range;
  if (!gets_own(request)) range = cut(pool, request);
  if (range.block == nullptr) {
    MemoryBlock& block = add_block(pool, request);
    const VkDeviceSize size = std::min(round_up(request.needs.size, step(request.type)), block.size);
    range = {.block = &block, .memory = block.memory, .offset = *block.free.take(size, 1), .size = size};
  }
  if (!request.mapped) return range;
  MemoryBlock& block = *range.block;
  if (block.mapped == nullptr) {
    void* mapped = nullptr;
    const VkResult result = calls_.map(device_, block.memory, 0, VK_WHOLE_SIZE, 0, &mapped);
    if (result != VK_SUCCESS) give_back(range);
    vk_check(result, "vkMapMemory", request.name);
    block.mapped = static_cast<std::byte*>(mapped);
  }
  range.mapped = block.mapped + range.offset;
  return range;
}

void DeviceMemory::give_back(const MemoryRange& range) {
  range.block->free.give_back(range.offset, range.size);
  free_if_empty(*range.block);
}

bool DeviceMemory::gets_own(const MemoryRequest& request) const {
  // A preference only concerns speed. It must not use up the allocations that other resources need.
  return request.requires_own || (request.prefers_own && allocations_ < max_allocations_ / 2);
}

// Memory that is not coherent is flushed and invalidated in whole atoms. No two ranges may share an atom.
VkDeviceSize DeviceMemory::step(std::uint32_t type) const {
  constexpr VkMemoryPropertyFlags kHost = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  const bool by_atoms = (memory_.memoryTypes[type].propertyFlags & kHost) == VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT;
  return by_atoms ? std::max(non_coherent_atom_, kHostAlignment) : kHostAlignment;
}

VkDeviceSize DeviceMemory::block_size(const Pool& pool, std::uint32_t type) const {
  const VkDeviceSize heap = memory_.memoryHeaps[memory_.memoryTypes[type].heapIndex].size;
  const VkDeviceSize largest = std::min(kLargestBlock, std::bit_floor(heap / kBlocksPerHeap));
  return std::max(kSmallestBlock, std::min(largest, std::bit_floor(pool.bytes / kGrowth)));
}

// Older blocks are filled first, so that younger ones become empty and can be freed.
MemoryRange DeviceMemory::cut(Pool& pool, const MemoryRequest& request) {
  const VkDeviceSize step = this->step(request.type), size = round_up(request.needs.size, step);
  const VkDeviceSize alignment = std::max(request.needs.alignment, step);
  for (const std::unique_ptr<MemoryBlock>& block : pool.blocks) {
    if (block->free.free_bytes() < size) continue;
    const std::optional<std::uint64_t> offset = block->free.take(size, alignment);
    if (offset) return {.block = block.get(), .memory = block->memory, .offset = *offset, .size = size};
  }
  return {};
}

// Adds a block with room for other resources if the request allows it and the heap has room; otherwise a block of
// exactly the requested size.
MemoryBlock& DeviceMemory::add_block(Pool& pool, const MemoryRequest& request) {
  const bool own = gets_own(request);
  const VkDeviceSize size = block_size(pool, request.type);
  const bool shared = !own && request.needs.size <= size / 2;
  const bool has_shared = shared && allocate(pool, request, size, false) == VK_SUCCESS;
  if (!has_shared) check(allocate(pool, request, request.needs.size, own), request);
  return *pool.blocks.back();
}

VkResult DeviceMemory::allocate(Pool& pool, const MemoryRequest& request, VkDeviceSize size, bool own) {
  if (allocations_ >= max_allocations_) return VK_ERROR_TOO_MANY_OBJECTS;
  if (size > memory_.memoryHeaps[memory_.memoryTypes[request.type].heapIndex].size) {
    return VK_ERROR_OUT_OF_DEVICE_MEMORY;
  }
  const VkMemoryDedicatedAllocateInfo dedicated{.sType = VK_STRUCTURE_TYPE_MEMORY_DEDICATED_ALLOCATE_INFO,
                                                .pNext = nullptr,
                                                .image = request.image,
                                                .buffer = request.buffer};
  const VkMemoryAllocateInfo info{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                  .pNext = own ? &dedicated : nullptr,
                                  .allocationSize = size,
                                  .memoryTypeIndex = request.type};
  // The block first, because nothing may throw once there is memory.
  pool.blocks.push_back(
      std::make_unique<MemoryBlock>(MemoryBlock{.pool = {request.type, request.image != VK_NULL_HANDLE},
                                                .memory = VK_NULL_HANDLE,
                                                .size = size,
                                                .free = FreeRanges(size)}));
  const VkResult result = calls_.allocate(device_, &info, nullptr, &pool.blocks.back()->memory);
  if (result != VK_SUCCESS) {
    pool.blocks.pop_back();
    return result;
  }
  pool.bytes += size;
  bytes_ += size;
  ++allocations_;
  return result;
}

void DeviceMemory::check(VkResult result, const MemoryRequest& request) const {
  if (result == VK_SUCCESS) return;
  const std::uint32_t heap = memory_.memoryTypes[request.type].heapIndex;
  vk_check(result, "vkAllocateMemory",
           std::to_string(request.needs.size) + " bytes for \"" + std::string(request.name) + "\" of heap " +
               std::to_string(heap) + " with " + std::to_string(memory_.memoryHeaps[heap].size) + " bytes; held are " +
               std::to_string(bytes_) + " bytes in " + std::to_string(allocations_) + " allocations of the " +
               std::to_string(max_allocations_) + " that the device allows");
}

void DeviceMemory::free_if_empty(MemoryBlock& block) {
  if (!block.free.all_free()) return;
  Pool& pool = pools_.at(block.pool);
  calls_.free(device_, block.memory, nullptr);
  pool.bytes -= block.size;
  bytes_ -= block.size;
  --allocations_;
  std::erase_if(pool.blocks, [&](const auto& known) { return known.get() == &block; });
}

}  // namespace simvis
