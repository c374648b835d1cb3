// The one command buffer of a frame: recorded, submitted, waited for.
#pragma once

#include "engine/vulkan/handle.h"

namespace simvis {

class FrameCommands {
 public:
  explicit FrameCommands(Device::Impl& device);
  /// Waits for what is in flight.
  ~FrameCommands();
  FrameCommands(const FrameCommands&) = delete;
  FrameCommands& operator=(const FrameCommands&) = delete;

  /// Starts recording. Nothing is in flight.
  VkCommandBuffer begin();
  /// Submits what was recorded.
  void submit();
  /// Waits until the device has done it; then destroys what was retired.
  void wait();
  void submit_and_wait() {
    submit();
    wait();
  }
  /// Gives up what was recorded, after an exception. What was submitted before has to be waited for.
  void abandon();

 private:
  Device::Impl& device_;
  Handle<VkCommandPool> pool_;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;  // freed with its pool
  Handle<VkFence> fence_;
  bool in_flight_ = false;
};

}  // namespace simvis
