// The Vulkan instance, with the validation layer and its messenger if they are requested.
#pragma once

#include <vulkan/vulkan.h>

#include <atomic>
#include <cstdint>
#include <filesystem>
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

}  // namespace simvis
