// The devices that are open in this process.
#pragma once

#include <memory>
#include <thread>

#include "engine/vulkan/sharing/shared_device.h"

namespace simvis {

/// The open device of this choice; opens it if no simulation holds one that can be used. Throws as Device.
std::shared_ptr<SharedDevice> shared_device(const DeviceChoice& choice);

/// Opens a device on a thread of its own, while its maker does something else. shared_device() then waits for it or
/// finds it open. An error is left to shared_device(), which tries again.
///
/// The bundled driver is chosen by setenv(), which is not safe beside threads that read the environment. So a build
/// with a bundled driver does not open a device in the background.
class DeviceOpening {
 public:
  explicit DeviceOpening(const DeviceChoice& choice);
  ~DeviceOpening();  ///< waits for the thread
  DeviceOpening(const DeviceOpening&) = delete;
  DeviceOpening& operator=(const DeviceOpening&) = delete;

 private:
  std::shared_ptr<SharedDevice> held_;
  std::thread thread_;
};

}  // namespace simvis
