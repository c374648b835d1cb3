// The single command buffer of a frame: it is recorded, submitted and waited for.
#pragma once

#include "engine/vulkan/handle.h"

namespace simvis {

class FrameCommands {
 public:
  explicit FrameCommands(DeviceImpl& device);
  /// Waits for the submission in flight, if there is one.
  ~FrameCommands();
  FrameCommands(const FrameCommands&) = delete;
  FrameCommands& operator=(const FrameCommands&) = delete;

  /// Starts recording. No submission may be in flight.
  VkCommandBuffer begin();
  /// Submits the recorded commands.
  void submit();
  /// Waits until the device has finished the submission, then destroys the retired objects.
  void wait();
  void submit_and_wait() {
    submit();
    wait();
  }
  /// Discards the recorded commands after an exception. Earlier submissions must still be waited for.
  void abandon();

 private:
  DeviceImpl& device_;
  Handle<VkCommandPool> pool_;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;  // freed with its pool
  Handle<VkFence> fence_;
  bool in_flight_ = false;
};

}  // namespace simvis
