#include "engine/vulkan/device_impl.h"

#include <algorithm>
#include <cstdlib>
#include <string>
#include <utility>

#include <simvis/error.h>
#include "engine/base/assert.h"
#include "engine/base/cache_file.h"
#include "engine/base/thread_pool.h"
#include "engine/vulkan/fence_wait.h"
#include "engine/vulkan/sharing/open_devices.h"

namespace simvis {
namespace {

constexpr VkMemoryPropertyFlags kLocal = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
constexpr VkMemoryPropertyFlags kMapped = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
constexpr VkMemoryPropertyFlags kCached = VK_MEMORY_PROPERTY_HOST_CACHED_BIT;

}  // namespace

bool wants_validation(const DeviceDesc& desc) {
  const char* environment = std::getenv("SIMVIS_VALIDATION");
  return desc.validation || (environment && std::string_view(environment) == "1");
}

DeviceChoice choice_of(const DeviceDesc& desc) {
  return {.validation = wants_validation(desc),
          .instrumented = desc.instrumented,
          .select = desc.select,
          .cache_folder = simvis::cache_folder(desc.cache_dir)};
}

DeviceImpl::DeviceImpl(const DeviceDesc& desc, unsigned pool_size) : DeviceImpl(shared_device(choice_of(desc))) {
  threads = shared_thread_pool(pool_size);
  progress = desc.progress;
  max_wait = simvis::max_wait();
}

DeviceImpl::DeviceImpl(std::shared_ptr<SharedDevice> of)
    : shared(std::move(of)),
      physical(shared->physical()),
      device(shared->get()),
      cache_folder(shared->choice().cache_folder),
      instrumented(shared->choice().instrumented),
      messages_before(shared->instance().messages()) {
  vkGetPhysicalDeviceMemoryProperties(physical.handle, &memory);
  device_memory = std::make_unique<DeviceMemory>(device, memory, limits());
  choose_upload();
}

// FrameCommands wait for what they have submitted before they end. If they have given up, the queue may still use the
// retired objects of all users.
DeviceImpl::~DeviceImpl() {
  if (finished < submitted || shared->has_unfinished()) {
    shared->unfinished().keep(std::move(retired_), std::move(device_memory));
    return;
  }
  finished = ++submitted;
  destroy_retired();
  SIMVIS_ASSERT(live_objects_ == 0);
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
  shared->name(type, handle, name);
  adopt_one();
}

void DeviceImpl::adopt_memory() { adopt_one(); }

void DeviceImpl::adopt_one() {
  if (retired_.capacity() <= live_objects_) retired_.reserve(2 * live_objects_ + 64);
  ++live_objects_;
}

void DeviceImpl::retire(std::function<void()> destroy) {
  const std::uint64_t serial = recording ? submitted + 1 : submitted;
  retired_.push_back({std::move(destroy), serial});
  if (serial <= finished) destroy_retired();
}

void DeviceImpl::destroy_retired() {
  if (shared->has_unfinished()) return;
  const auto first_used =
      std::ranges::find_if(retired_, [&](const Retired& object) { return object.serial > finished; });
  for (auto object = retired_.begin(); object != first_used; ++object) object->destroy();
  live_objects_ -= static_cast<std::uint64_t>(first_used - retired_.begin());
  retired_.erase(retired_.begin(), first_used);
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
    shared->draw_many()(commands, static_cast<std::uint32_t>(count), &draws[first], instance_count, first_instance,
                        sizeof draws[0], nullptr);
  }
}

}  // namespace simvis
