// A move-only owner of one Vulkan object. Its destructor puts the object on the device's retire list. The device
// destroys the object when the submission that may still use it has finished. handle.cpp lists the supported types.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <string_view>
#include <utility>

#include "engine/vulkan/device_impl.h"

namespace simvis {

template <typename T>
class Handle {
 public:
  Handle() = default;
  /// Takes ownership of `handle`. The name appears in messages of the validation layer and in debuggers.
  Handle(DeviceImpl& device, T handle, std::string_view name);
  ~Handle() { retire(); }
  Handle(Handle&& other) noexcept : device_(other.device_), handle_(std::exchange(other.handle_, VK_NULL_HANDLE)) {}
  Handle& operator=(Handle&& other) noexcept {
    if (this != &other) {
      retire();
      device_ = other.device_;
      handle_ = std::exchange(other.handle_, VK_NULL_HANDLE);
    }
    return *this;
  }

  T get() const { return handle_; }
  explicit operator bool() const { return handle_ != VK_NULL_HANDLE; }

 private:
  void retire();

  DeviceImpl* device_ = nullptr;
  T handle_ = VK_NULL_HANDLE;
};

}  // namespace simvis
