// The Vulkan instance, with the validation layer and its messenger if they are requested, and a lock around the lists
// of the Vulkan loader.
#pragma once

#include <vulkan/vulkan.h>

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <shared_mutex>
#include <vector>

namespace simvis {

class Instance {
 public:
  /// `driver` is the JSON file that describes a driver (Vulkan's ICD manifest), which is then the only one; empty: the
  /// drivers of the system. Throws MachineError if there is no Vulkan driver, or if the validation layer is requested
  /// but not installed. The message says what to install.
  explicit Instance(bool validation, const std::filesystem::path& driver = {});
  ~Instance();
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  VkInstance get() const { return instance_; }
  bool validation() const { return messenger_ != VK_NULL_HANDLE; }
  std::uint64_t messages() const { return messages_; }

  /// Never empty: throws MachineError if there is no device.
  std::vector<VkPhysicalDevice> physical_devices() const;

 private:
  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  std::atomic<std::uint64_t> messages_ = 0;
};

/// The loader looks through all instances and devices of the process when an object gets a name, without a lock of its
/// own (seen in version 1.3.239, terminator of vkSetDebugUtilsObjectNameEXT). A thread that creates or destroys an
/// instance or a device holds this mutex alone; a thread that names an object shares it.
std::shared_mutex& loader_lists();

}  // namespace simvis
