#include "engine/vulkan/sharing/open_devices.h"

#include <exception>
#include <map>
#include <mutex>
#include <system_error>

#include "engine/vulkan/sharing/stalled_devices.h"

namespace simvis {

std::shared_ptr<SharedDevice> shared_device(const DeviceChoice& choice) {
  static std::mutex mutex;
  static std::map<DeviceChoice, std::weak_ptr<SharedDevice>> open;
  const std::lock_guard lock(mutex);
  std::weak_ptr<SharedDevice>& place = open[choice];
  std::shared_ptr<SharedDevice> device = place.lock();
  if (device == nullptr || device->given_up()) {
    close_stalled_devices();
    device = {new SharedDevice(find_device(choice.validation, choice.select, bundled_driver()), choice),
              [](SharedDevice* ended) { close_or_keep(std::unique_ptr<SharedDevice>(ended)); }};
    place = device;
  }
  return device;
}

DeviceOpening::DeviceOpening(const DeviceChoice& choice) {
  if (!bundled_driver().empty()) return;
  try {
    thread_ = std::thread([this, choice] {
      try {
        held_ = shared_device(choice);
      } catch (const std::exception&) {
      }
    });
  } catch (const std::system_error&) {  // the system has no more threads
  }
}

DeviceOpening::~DeviceOpening() {
  if (thread_.joinable()) thread_.join();
}

}  // namespace simvis
