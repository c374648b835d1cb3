// The single command buffer of a frame: it is recorded, submitted and waited for.
#pragma once

#include <string>

#include "engine/vulkan/handle.h"

namespace simvis {

class FrameCommands {
 public:
  /// `purpose` says in messages what was waited for: "the drawing of a frame".
  FrameCommands(DeviceImpl& device, std::string purpose);
  /// Waits for the submission in flight, if there is one. If that fails, or wait() has failed, all that the submission
  /// may use is left to SharedDevice::unfinished().
  ~FrameCommands();
  FrameCommands(const FrameCommands&) = delete;
  FrameCommands& operator=(const FrameCommands&) = delete;

  /// Starts recording. No submission may be in flight. Throws MachineError if the device was given up.
  VkCommandBuffer begin();
  /// Submits the recorded commands.
  void submit();
  /// Waits until the device has finished the submission, then destroys the retired objects. Throws MachineError if the
  /// device is lost or does not finish within DeviceImpl::max_wait: the device is then given up.
  void wait();
  void submit_and_wait() {
    submit();
    wait();
  }
  /// Discards the recorded commands after an exception. Earlier submissions must still be waited for.
  void abandon();

 private:
  void give_up(VkResult result, const char* call);
  void end_submission();

  DeviceImpl& device_;
  std::string purpose_;
  Handle<VkCommandPool> pool_;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;  // freed with its pool
  Handle<VkFence> fence_;
  bool in_flight_ = false;
};

}  // namespace simvis
