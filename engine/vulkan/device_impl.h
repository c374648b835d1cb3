// The implementation of Device, for the engine's own files.
#pragma once

#include <vulkan/vulkan.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include <simvis/device_info.h>
#include "engine/base/process_use.h"
#include "engine/vulkan/device_memory.h"
#include "engine/vulkan/sharing/shared_device.h"

namespace simvis {

class ThreadPool;

/// The use of memory. The device selects its best memory type for it.
enum class MemoryKind : std::uint8_t {
  device,    ///< written once, read often by the GPU; mapped where `direct_upload`
  image,     ///< for images, never mapped
  dynamic,   ///< written by the host each frame, read by the GPU; mapped
  staging,   ///< written by the host, source of copies; mapped
  readback,  ///< target of copies, read by the host; mapped
};

/// Whether the description or SIMVIS_VALIDATION=1 asks for the validation layer.
bool wants_validation(const DeviceDesc& desc);

/// The device that `desc` asks for.
DeviceChoice choice_of(const DeviceDesc& desc);

/// One user of a device that several may share: its memory, its objects and its submissions.
struct DeviceImpl {
  DeviceImpl(const DeviceDesc& desc, unsigned pool_size);
  /// For objects that users of the device share. It submits nothing.
  explicit DeviceImpl(std::shared_ptr<SharedDevice> device);
  ~DeviceImpl();
  DeviceImpl(const DeviceImpl&) = delete;
  DeviceImpl& operator=(const DeviceImpl&) = delete;

  const VkPhysicalDeviceLimits& limits() const { return physical.properties.limits; }

  /// Index of the memory type for `kind`. Throws MachineError if no type of `allowed_types` (one bit per type) is
  /// suitable.
  std::uint32_t memory_type(std::uint32_t allowed_types, MemoryKind kind) const;

  /// Every object that a Handle owns passes through adopt() and retire(). Every MemorySlice passes through
  /// adopt_memory() and retire().
  void adopt(VkObjectType type, std::uint64_t handle, std::string_view name);
  void adopt_memory();
  void disown_memory() { --live_objects_; }  ///< after adopt_memory(), if there is none
  /// Of what was adopted. Throws nothing: adopt() has made room. A function that holds two addresses allocates nothing.
  void retire(std::function<void()> destroy);
  /// Destroys the retired objects that no unfinished submission may use. None while the device has unfinished work.
  void destroy_retired();
  std::uint64_t live_objects() const { return live_objects_; }

  void begin_label(VkCommandBuffer commands, std::string_view name) const { shared->begin_label(commands, name); }
  void end_label(VkCommandBuffer commands) const { shared->end_label(commands); }

  /// Same as vkCmdDrawIndexed for each of `draws`, in this order. Uses VK_EXT_multi_draw if the device supports it.
  void draw_indexed(VkCommandBuffer commands, std::span<const VkMultiDrawIndexedInfoEXT> draws,
                    std::uint32_t instance_count, std::uint32_t first_instance) const;

  ProcessUse process;  ///< this user counts, also without a simulation
  std::shared_ptr<SharedDevice> shared;
  PhysicalDevice physical;
  VkPhysicalDeviceMemoryProperties memory{};
  VkDevice device = VK_NULL_HANDLE;
  std::filesystem::path cache_folder;  ///< empty: nothing is kept on disk
  std::unique_ptr<DeviceMemory> device_memory;
  std::shared_ptr<ThreadPool> threads;  ///< for all host work of this user
  ProgressCallback progress;

  void report(const Progress& how_far) const {
    if (progress) progress(how_far);
  }

  /// Whether the host writes directly into device memory. It does so on CPU devices and wherever the host can access
  /// all of the device's memory. Otherwise, data goes through staging buffers and copies. Set once by the constructor.
  bool direct_upload = false;

  /// Whether queries time and count the device's work, see DeviceDesc. If false, no query pool exists.
  bool instrumented = false;
  std::uint64_t memory_bytes = 0;     ///< of all existing buffers and images of this user
  std::uint64_t messages_before = 0;  ///< of the validation layer, when this user began

  std::chrono::nanoseconds max_wait{};  ///< for one submission

  // Submissions are numbered from 1. While commands are recorded, the next submission may still use an object that is
  // retired.
  std::uint64_t submitted = 0, finished = 0;
  bool recording = false;

 private:
  void choose_upload();

  void adopt_one();

  std::vector<Retired> retired_;  // has room for all live objects
  std::uint64_t live_objects_ = 0;
};

}  // namespace simvis
