// The policy is tested with calls that return made-up memory, its effect on real resources with the device.
#include "engine/vulkan/device_memory.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <simvis/device.h>
#include <simvis/error.h>
#include "engine/vulkan/buffer.h"
#include "engine/vulkan/device_impl.h"
#include "engine/vulkan/gpu_image.h"
#include "tests/support/random_numbers.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("engine");

using namespace simvis;

namespace {

constexpr VkDeviceSize kKiB = 1024, kMiB = 1024 * kKiB, kGiB = 1024 * kMiB;
constexpr std::uint32_t kCoherent = 0, kIncoherent = 1;  // memory types

/// A device with made-up memory.
struct MadeUpDevice {
  struct Allocation {
    VkDeviceSize size;
    bool dedicated;
    std::vector<std::byte> bytes{};  // once mapped
  };
  std::map<std::uint64_t, Allocation> held{};
  std::uint64_t allocated = 0, mapped = 0;  // calls
  VkDeviceSize largest = VK_WHOLE_SIZE;     // the largest that it returns
  VkResult map_result = VK_SUCCESS;
};
MadeUpDevice* made_up = nullptr;

VkResult hand_out(VkDevice, const VkMemoryAllocateInfo* info, const VkAllocationCallbacks*, VkDeviceMemory* memory) {
  if (info->allocationSize > made_up->largest) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
  const std::uint64_t handle = ++made_up->allocated;
  made_up->held[handle] = {info->allocationSize, info->pNext != nullptr};
  *memory = reinterpret_cast<VkDeviceMemory>(handle);
  return VK_SUCCESS;
}

void take_back(VkDevice, VkDeviceMemory memory, const VkAllocationCallbacks*) {
  CHECK(made_up->held.erase(reinterpret_cast<std::uint64_t>(memory)) == 1);
}

VkResult show_to_host(VkDevice, VkDeviceMemory memory, VkDeviceSize, VkDeviceSize, VkMemoryMapFlags, void** mapped) {
  ++made_up->mapped;
  MadeUpDevice::Allocation& allocation = made_up->held.at(reinterpret_cast<std::uint64_t>(memory));
  allocation.bytes.resize(allocation.size);
  *mapped = allocation.bytes.data();
  return made_up->map_result;
}

struct Fixture {
  MadeUpDevice device;
  VkPhysicalDeviceMemoryProperties properties{};
  VkPhysicalDeviceLimits limits{};

  Fixture() {
    made_up = &device;
    properties.memoryTypeCount = 2;
    properties.memoryTypes[kCoherent] = {VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT | VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                                             VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
                                         0};
    properties.memoryTypes[kIncoherent] = {VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT, 0};
    properties.memoryHeapCount = 1;
    properties.memoryHeaps[0] = {16 * kGiB, 0};
    limits.maxMemoryAllocationCount = 4096;
    limits.nonCoherentAtomSize = 256;
  }
  DeviceMemory memory() const {
    return DeviceMemory(VK_NULL_HANDLE, properties, limits,
                        {.allocate = hand_out, .free = take_back, .map = show_to_host});
  }
  VkDeviceSize size_of(const MemoryRange& range) const {
    return device.held.at(reinterpret_cast<std::uint64_t>(range.memory)).size;
  }
};

MemoryRequest buffer(VkDeviceSize size, VkDeviceSize alignment = 1) {
  return {.name = "buffer of a test",
          .needs = {.size = size, .alignment = alignment, .memoryTypeBits = 3},
          .type = kCoherent,
          .buffer = reinterpret_cast<VkBuffer>(std::uint64_t{1})};
}

MemoryRequest image(VkDeviceSize size) {
  MemoryRequest request = buffer(size);
  request.buffer = VK_NULL_HANDLE;
  request.image = reinterpret_cast<VkImage>(std::uint64_t{1});
  return request;
}

std::string machine_error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const MachineError& error) {
    return error.what();
  }
  return "nothing was thrown";
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE_FIXTURE(Fixture, "small resources share a block, which is freed when it is empty") {
  DeviceMemory memory = this->memory();
  const MemoryRange a = memory.take(buffer(100)), b = memory.take(buffer(200));
  CHECK(a.memory == b.memory);
  CHECK(a.offset == 0);
  CHECK(b.offset == 128);  // the next multiple of kHostAlignment
  CHECK(memory.allocations() == 1);
  CHECK(memory.bytes() == kMiB);
  CHECK(a.mapped == nullptr);
  memory.give_back(a);
  CHECK(device.held.size() == 1);
  memory.give_back(b);
  CHECK(device.held.empty());
  CHECK(memory.allocations() == 0);
  CHECK(memory.bytes() == 0);
}

TEST_CASE_FIXTURE(Fixture, "images and buffers never share a block, nor do two memory types") {
  DeviceMemory memory = this->memory();
  MemoryRequest incoherent = buffer(100);
  incoherent.type = kIncoherent;
  const MemoryRange ranges[] = {memory.take(buffer(100)), memory.take(image(100)), memory.take(incoherent)};
  CHECK(memory.allocations() == 3);
  for (const MemoryRange& range : ranges) memory.give_back(range);
}

TEST_CASE_FIXTURE(Fixture, "blocks grow with the held memory, up to 64 MiB and a 64th of the heap") {
  for (const VkDeviceSize heap : {16 * kGiB, 512 * kMiB}) {
    CAPTURE(heap);
    properties.memoryHeaps[0].size = heap;
    DeviceMemory memory = this->memory();
    std::vector<MemoryRange> ranges;
    VkDeviceSize held = 0;
    while (held < 300 * kMiB) {
      const VkDeviceSize before = memory.bytes();
      ranges.push_back(memory.take(buffer(256 * kKiB)));
      held += 256 * kKiB;
      CHECK(memory.bytes() <= held + std::max(kMiB, held / 4));
      if (memory.bytes() == before) continue;
      CHECK(size_of(ranges.back()) <= std::max(kMiB, before / 4));
    }
    CHECK(size_of(ranges.back()) == std::min(64 * kMiB, heap / 64));
    CHECK(memory.allocations() < (heap == 16 * kGiB ? 40 : 80));
    for (const MemoryRange& range : ranges) memory.give_back(range);
    CHECK(device.held.empty());
  }
}

TEST_CASE_FIXTURE(Fixture,
                  "resources that fill more than half a block, or require it, have an allocation of their own size") {
  DeviceMemory memory = this->memory();
  const MemoryRange large = memory.take(buffer(kMiB / 2 + 1));
  CHECK(size_of(large) == kMiB / 2 + 1);
  MemoryRequest request = image(1000);
  request.requires_own = true;
  const MemoryRange needed = memory.take(request);
  CHECK(size_of(needed) == 1000);
  CHECK(device.held.at(2).dedicated);
  CHECK(!device.held.at(1).dedicated);
  memory.give_back(large);
  memory.give_back(needed);
  CHECK(device.held.empty());
}

TEST_CASE_FIXTURE(Fixture, "separate allocations that the device prefers are at most half of all allocations") {
  limits.maxMemoryAllocationCount = 8;
  DeviceMemory memory = this->memory();
  std::vector<MemoryRange> ranges;
  MemoryRequest request = image(1000);
  request.prefers_own = true;
  for (int i = 0; i < 100; ++i) ranges.push_back(memory.take(request));
  CHECK(memory.allocations() == 5);  // four of their own, and a block
  for (const MemoryRange& range : ranges) memory.give_back(range);
}

TEST_CASE_FIXTURE(Fixture, "the limit of the device on allocations is respected, and an error names it") {
  limits.maxMemoryAllocationCount = 3;
  DeviceMemory memory = this->memory();
  std::vector<MemoryRange> ranges;
  for (int i = 0; i < 3; ++i) ranges.push_back(memory.take(buffer(kMiB)));
  const std::string error = machine_error_of([&] { memory.take(buffer(2 * kMiB)); });
  CHECK(contains(error, "vkAllocateMemory: VK_ERROR_TOO_MANY_OBJECTS"));
  CHECK(contains(error, "2097152 bytes for \"buffer of a test\""));
  CHECK(contains(error, "3 allocations of the 3"));
  CHECK(device.allocated == 3);
  memory.give_back(ranges.back());
  ranges.back() = memory.take(buffer(100));
  ranges.push_back(memory.take(buffer(100)));  // cut out of the last one
  CHECK(memory.allocations() == 3);
  for (const MemoryRange& range : ranges) memory.give_back(range);
}

TEST_CASE_FIXTURE(Fixture,
                  "a heap without room for a block may still hold the resource; an error tells what it lacks") {
  DeviceMemory memory = this->memory();
  device.largest = 4096;
  const MemoryRange fits = memory.take(buffer(4096));
  CHECK(size_of(fits) == 4096);
  const std::string error = machine_error_of([&] { memory.take(buffer(4097)); });
  CHECK(contains(error, "vkAllocateMemory: VK_ERROR_OUT_OF_DEVICE_MEMORY"));
  CHECK(contains(error, "4097 bytes for \"buffer of a test\" of heap 0 with 17179869184 bytes"));
  CHECK(contains(error, "held are 4096 bytes in 1 allocations"));
  CHECK(memory.bytes() == 4096);
  memory.give_back(fits);
}

TEST_CASE_FIXTURE(Fixture, "no more memory is requested than the heap of the device has") {
  DeviceMemory memory = this->memory();
  const std::string error = machine_error_of([&] { memory.take(buffer(16 * kGiB + 1)); });
  CHECK(contains(error, "VK_ERROR_OUT_OF_DEVICE_MEMORY"));
  CHECK(device.allocated == 0);
}

TEST_CASE_FIXTURE(Fixture, "a block is mapped once, for the resources that need it") {
  DeviceMemory memory = this->memory();
  MemoryRequest request = buffer(100);
  const MemoryRange unmapped = memory.take(request);
  CHECK(device.mapped == 0);
  request.mapped = true;
  const MemoryRange a = memory.take(request), b = memory.take(request);
  CHECK(device.mapped == 1);
  CHECK(a.mapped == device.held.at(1).bytes.data() + a.offset);
  CHECK(b.mapped == a.mapped + (b.offset - a.offset));
  for (const MemoryRange& range : {unmapped, a, b}) memory.give_back(range);

  device.map_result = VK_ERROR_MEMORY_MAP_FAILED;
  CHECK(contains(machine_error_of([&] { memory.take(request); }),
                 "vkMapMemory: VK_ERROR_MEMORY_MAP_FAILED (-5): buffer of a test"));
  CHECK(device.held.empty());
}

TEST_CASE_FIXTURE(Fixture, "ranges that are flushed by atoms share no atom") {
  DeviceMemory memory = this->memory();
  MemoryRequest request = buffer(10);
  request.type = kIncoherent;
  const MemoryRange a = memory.take(request), b = memory.take(request);
  CHECK(a.offset == 0);
  CHECK(b.offset == limits.nonCoherentAtomSize);
  CHECK(b.size == limits.nonCoherentAtomSize);
  memory.give_back(a);
  memory.give_back(b);
}

TEST_CASE_FIXTURE(Fixture, "many ranges never overlap, are aligned as requested, and are all returned") {
  constexpr int kCalls = 100'000;
  struct Used {
    MemoryRange range;
    VkDeviceSize size;
  };
  test::Random random(5);
  DeviceMemory memory = this->memory();
  std::vector<Used> used;
  std::map<VkDeviceMemory, std::map<VkDeviceSize, VkDeviceSize>> places;  // by first byte: the end
  for (int call = 0; call < kCalls; ++call) {
    if (used.empty() || random.below(100) < (call < kCalls / 2 ? 55u : 45u)) {
      const VkDeviceSize alignment = VkDeviceSize{1} << random.below(13);
      MemoryRequest request = random.below(2) ? buffer(1, alignment) : image(1);
      request.needs.size = 1 + random.below(random.below(50) ? 40 * kKiB : 2 * kMiB);
      request.prefers_own = random.below(200) == 0;
      const MemoryRange range = memory.take(request);
      REQUIRE(range.size >= request.needs.size);
      REQUIRE(range.offset % request.needs.alignment == 0);
      REQUIRE(range.offset + request.needs.size <= size_of(range));
      auto& in_block = places[range.memory];
      const auto next = in_block.lower_bound(range.offset);
      if (next != in_block.end()) REQUIRE(range.offset + range.size <= next->first);
      if (next != in_block.begin()) REQUIRE(std::prev(next)->second <= range.offset);
      in_block.emplace(range.offset, range.offset + range.size);
      used.push_back({range, request.needs.size});
    } else {
      std::swap(used[random.below(used.size())], used.back());
      const MemoryRange range = used.back().range;
      CHECK(places.at(range.memory).erase(range.offset) == 1);
      if (places.at(range.memory).empty()) places.erase(range.memory);
      memory.give_back(range);
      used.pop_back();
    }
    REQUIRE(memory.allocations() == places.size());
  }
  for (const Used& each : used) memory.give_back(each.range);
  CHECK(device.held.empty());
}

namespace {

Device& real_device() {
  static Device device({.select = "", .validation = false, .cache_dir = tested_build() + "/device_memory_test"});
  return device;
}

BufferDesc buffer_desc(VkDeviceSize size) {
  return {.name = "buffer of a test",
          .size = size,
          .usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
          .memory = MemoryKind::staging};
}

}  // namespace

TEST_CASE("ten thousand buffers and five thousand textures take few allocations and share no byte") {
  // The growth of blocks gives 21 for 80 MB of buffers and 23 for 110 MB of textures; a device may ask for more bytes
  // or for some allocations of their own.
  constexpr std::uint64_t kMaxAllocations = 100;
  DeviceImpl& impl = real_device().impl();
  const std::uint64_t objects = impl.live_objects(), bytes = impl.memory_bytes;
  {
    test::Random random(3);
    std::vector<Buffer> buffers;
    std::uint64_t sum = bytes;
    for (int i = 0; i < 10'000; ++i) {
      const Buffer& made = buffers.emplace_back(impl, buffer_desc(1 + random.below(16 * kKiB)));
      REQUIRE(reinterpret_cast<std::uintptr_t>(made.mapped()) % DeviceMemory::kHostAlignment == 0);
      std::memset(made.mapped(), i % 251, made.size());
      sum += made.memory_bytes();
    }
    std::vector<GpuImage> textures;
    for (int i = 0; i < 5'000; ++i) {
      const GpuImage& made = textures.emplace_back(
          impl, GpuImageDesc{.name = "texture of a test",
                             .width = 64,
                             .height = 64,
                             .mip_levels = 7,
                             .format = VK_FORMAT_R8G8B8A8_SRGB,
                             .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT});
      sum += made.memory_bytes();
    }
    CHECK(impl.memory_bytes == sum);
    CHECK(impl.device_memory->bytes() >= sum);
    CHECK(impl.device_memory->allocations() < kMaxAllocations);
    MESSAGE(impl.device_memory->allocations()
            << " allocations of " << impl.device_memory->bytes() << " bytes for " << sum << " bytes of resources");
    bool whole = true;
    for (std::size_t i = 0; i < buffers.size(); ++i) {
      const std::byte* const first = buffers[i].mapped();
      const auto same = [&](std::byte byte) { return byte == static_cast<std::byte>(i % 251); };
      whole = whole && std::all_of(first, first + buffers[i].size(), same);
    }
    CHECK(whole);
  }
  CHECK(impl.device_memory->allocations() == 0);
  CHECK(impl.memory_bytes == bytes);
  CHECK(impl.live_objects() == objects);
}

TEST_CASE("memory is reused only after the submission that may use it has finished") {
  DeviceImpl& impl = real_device().impl();
  const Buffer keeps_block(impl, buffer_desc(100));
  Buffer buffer(impl, buffer_desc(100));
  const std::byte* const place = buffer.mapped();
  impl.recording = true;
  buffer = Buffer();
  const Buffer during(impl, buffer_desc(100));
  CHECK(during.mapped() != place);
  impl.recording = false;
  impl.finished = ++impl.submitted;
  impl.destroy_retired();
  const Buffer after(impl, buffer_desc(100));
  CHECK(after.mapped() == place);
}

TEST_CASE("a buffer that does not fit into memory leaves nothing behind") {
  DeviceImpl& impl = real_device().impl();
  const std::uint64_t objects = impl.live_objects();
  REQUIRE(impl.device_memory->allocations() == 0);
  VkPhysicalDeviceLimits limits = impl.limits();
  limits.maxMemoryAllocationCount = 1;
  impl.device_memory = std::make_unique<DeviceMemory>(impl.device, impl.memory, limits);
  {
    const Buffer fits(impl, buffer_desc(2 * kMiB));
    const std::string error = machine_error_of([&] { Buffer(impl, buffer_desc(3 * kMiB)); });
    CHECK(contains(error, "VK_ERROR_TOO_MANY_OBJECTS"));
    CHECK(contains(error, "3145728 bytes for \"buffer of a test\""));
    CHECK(impl.live_objects() == objects + 2);  // the buffer that fits, and its memory
    CHECK(impl.memory_bytes == fits.memory_bytes());
  }
  impl.device_memory = std::make_unique<DeviceMemory>(impl.device, impl.memory, impl.limits());
  CHECK(impl.live_objects() == objects);
}

TEST_SUITE_END();
