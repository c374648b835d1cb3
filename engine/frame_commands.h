// The one command buffer of a frame: recorded, submitted, waited for.
#pragma once

#include "engine/handle.h"

namespace simvis {

class FrameCommands {
 public:
  explicit FrameCommands(Device::Impl& device);

  /// Starts recording. Nothing is in flight.
  VkCommandBuffer begin();
  /// Submits what was recorded and waits until the device has done it; then destroys what was retired.
  void submit_and_wait();
  /// Gives up what was recorded, after an exception.
  void abandon();

 private:
  Device::Impl& device_;
  Handle<VkCommandPool> pool_;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;  // freed with its pool
  Handle<VkFence> fence_;
};

}  // namespace simvis
