// The inside of Device, for the engine's own files.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include <simvis/device.h>
#include "engine/vulkan/device_memory.h"
#include "engine/vulkan/instance.h"
#include "engine/vulkan/physical_device.h"
#include "engine/vulkan/pipeline_cache.h"

namespace simvis {

class ThreadPool;

/// What memory is for; the device picks the best type that it has.
enum class MemoryKind : std::uint8_t {
  device,    ///< written once, read often by the GPU; mapped where `direct_upload`
  image,     ///< for images, never mapped
  dynamic,   ///< written by the host each frame, read by the GPU; mapped
  staging,   ///< written by the host, copied from; mapped
  readback,  ///< copied to, read by the host; mapped
};

/// An object that nobody owns any more.
struct Retired {
  std::function<void()> destroy;
  std::uint64_t serial = 0;  ///< the last submission that may use it
};

struct Device::Impl {
  Impl(const DeviceDesc& desc, unsigned pool_size);
  ~Impl();
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  const VkPhysicalDeviceLimits& limits() const { return physical.properties.limits; }

  /// Throws MachineError when no type of `allowed_types` (a bit per type) serves.
  std::uint32_t memory_type(std::uint32_t allowed_types, MemoryKind kind) const;

  /// Every object that Handle owns passes through adopt() and retire(), every MemorySlice through adopt_memory() and
  /// retire().
  void adopt(VkObjectType type, std::uint64_t handle, std::string_view name);
  void adopt_memory() { ++live_objects_; }
  void retire(std::function<void()> destroy);
  /// Destroys what no unfinished submission may use.
  void destroy_retired();
  std::uint64_t live_objects() const { return live_objects_; }

  /// Labels for debuggers and messages; they cost nothing without validation.
  void begin_label(VkCommandBuffer commands, std::string_view name) const;
  void end_label(VkCommandBuffer commands) const;

  /// As vkCmdDrawIndexed for each, in this order, by one command where the device can.
  void draw_indexed(VkCommandBuffer commands, std::span<const VkMultiDrawIndexedInfoEXT> draws,
                    std::uint32_t instance_count, std::uint32_t first_instance) const;

  Instance instance;
  PhysicalDevice physical;
  VkPhysicalDeviceMemoryProperties memory{};
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  std::filesystem::path cache_folder;  ///< empty: nothing is kept on disk
  std::optional<DeviceMemory> device_memory;
  std::optional<PipelineCache> pipeline_cache;
  std::shared_ptr<ThreadPool> threads;  ///< of all that works on the host for this device
  ProgressCallback progress;

  void report(const Progress& how_far) const {
    if (progress) progress(how_far);
  }

  /// The host writes straight into device memory: on CPU devices, and where the whole of the device's memory is
  /// visible to the host. Otherwise data goes through staging buffers and copies. Chosen once.
  bool direct_upload = false;

  /// Times and counts what the device does, see DeviceDesc. Without: no query pool exists.
  bool instrumented = false;
  std::uint64_t memory_bytes = 0;  ///< of all buffers and images that live

  // Submissions are numbered from 1. While commands are recorded, what is retired may be used by the next one.
  std::uint64_t submitted = 0, finished = 0;
  bool recording = false;

 private:
  void create_device();
  void choose_upload();

  std::deque<Retired> retired_;
  std::uint64_t live_objects_ = 0;
  PFN_vkCmdDrawMultiIndexedEXT draw_many_ = nullptr;
  PFN_vkSetDebugUtilsObjectNameEXT set_name_ = nullptr;
  PFN_vkCmdBeginDebugUtilsLabelEXT begin_label_ = nullptr;
  PFN_vkCmdEndDebugUtilsLabelEXT end_label_ = nullptr;
};

}  // namespace simvis
