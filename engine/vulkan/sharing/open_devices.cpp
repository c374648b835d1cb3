#include "engine/vulkan/sharing/open_devices.h"

#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <map>
#include <mutex>
#include <system_error>
#include <utility>
#include <vector>

namespace simvis {
namespace {

// A driver that draws with threads of the process crashes when exit() destroys its data under them. So exit() first
// waits for them, and after this time ends the process at once.
constexpr std::chrono::seconds kExitWait{10};
constexpr std::chrono::milliseconds kExitPoll{5};

// Devices without a user whose queues may still work.
struct StalledDevices {
  std::mutex mutex;  // protects all members
  std::vector<std::unique_ptr<SharedDevice>> devices;
  pid_t process = 0;  // that waits at its end; 0: none

  void close_ended() {
    const std::lock_guard lock(mutex);
    std::erase_if(devices, [](const auto& device) { return !device->has_unfinished(); });
  }
  bool draws_on_host() {
    const std::lock_guard lock(mutex);
    return std::ranges::any_of(devices, [](const auto& device) { return device->physical().is_cpu(); });
  }
};

// Never destroyed, since threads of drivers may outlive all destructors.
StalledDevices& stalled_devices() {
  static auto* const stalled = new StalledDevices;
  return *stalled;
}

void wait_at_exit(int status, void*) {
  StalledDevices& stalled = stalled_devices();
  if (stalled.process != ::getpid()) return;  // a forked process has none of the driver's threads
  const auto end = std::chrono::steady_clock::now() + kExitWait;
  for (stalled.close_ended(); stalled.draws_on_host(); stalled.close_ended()) {
    if (std::chrono::steady_clock::now() > end) {
      std::fflush(nullptr);
      ::_exit(status);
    }
    std::this_thread::sleep_for(kExitPoll);
  }
}

// Closes the device, or keeps it until its queue has ended its work. At the end of the process, devices that draw with
// threads of the process are waited for, see kExitWait.
void close_or_keep(std::unique_ptr<SharedDevice> device) {
  if (!device->has_unfinished()) return;
  StalledDevices& stalled = stalled_devices();
  const std::lock_guard lock(stalled.mutex);
  stalled.devices.push_back(std::move(device));
  // The driver is loaded, so this runs before the destructors of its data.
  if (stalled.process == 0 && ::on_exit(wait_at_exit, nullptr) == 0) stalled.process = ::getpid();
}

}  // namespace

std::shared_ptr<SharedDevice> shared_device(const DeviceChoice& choice) {
  static std::mutex mutex;
  static std::map<DeviceChoice, std::weak_ptr<SharedDevice>> open;
  const std::lock_guard lock(mutex);
  std::weak_ptr<SharedDevice>& place = open[choice];
  std::shared_ptr<SharedDevice> device = place.lock();
  if (device == nullptr || device->given_up()) {
    stalled_devices().close_ended();
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
