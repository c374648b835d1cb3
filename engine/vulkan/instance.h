// The Vulkan instance, with the validation layer and its messenger when they are asked for.
#pragma once

#include <vulkan/vulkan.h>

#include <atomic>
#include <cstdint>
#include <vector>

namespace simvis {

class Instance {
 public:
  /// Throws MachineError when there is no Vulkan driver, or no validation layer although it is asked for; the message
  /// says what to install.
  explicit Instance(bool validation);
  ~Instance();
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  VkInstance get() const { return instance_; }
  bool validation() const { return messenger_ != VK_NULL_HANDLE; }
  std::uint64_t messages() const { return messages_; }

  /// Never empty: throws MachineError when there is no device.
  std::vector<VkPhysicalDevice> physical_devices() const;

 private:
  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  std::atomic<std::uint64_t> messages_ = 0;
};

}  // namespace simvis
