#include "engine/vulkan/found_device.h"

#include <system_error>

#include <simvis/error.h>
#include "engine/base/beside_library.h"

namespace simvis {
namespace {

constexpr const char* kBundled = "bundled";  // as DeviceDesc::select

std::vector<FoundDevice> devices_of(bool validation, const std::filesystem::path& driver) {
  const auto instance = std::make_shared<Instance>(validation, driver);
  std::vector<FoundDevice> found;
  for (VkPhysicalDevice handle : instance->physical_devices()) {
    found.push_back({instance, examine(handle)});
    if (!driver.empty()) found.back().physical.info.driver += ", bundled";
  }
  return found;
}

}  // namespace

std::filesystem::path bundled_driver() {
  std::error_code error;
  const std::filesystem::path file = beside_library("bundled_driver.json");
  return std::filesystem::exists(file, error) ? file : std::filesystem::path();
}

std::vector<FoundDevice> find_devices(bool validation, const std::filesystem::path& bundled) {
  if (bundled.empty()) return devices_of(validation, {});
  std::vector<FoundDevice> found;
  try {
    found = devices_of(validation, {});
  } catch (const MachineError&) {
    // The system has no driver of its own.
  }
  for (FoundDevice& device : devices_of(validation, bundled)) found.push_back(std::move(device));
  return found;
}

FoundDevice find_device(bool validation, const std::string& select, const std::filesystem::path& bundled) {
  if (select != kBundled) {
    const std::vector<FoundDevice> devices = find_devices(validation, bundled);
    return devices[choose_device(infos(devices), select)];
  }
  if (bundled.empty()) {
    throw InputError(
        "device \"bundled\": this SimVis was built without a driver of its own, expected an index or a part of a name");
  }
  const std::vector<FoundDevice> devices = devices_of(validation, bundled);
  return devices[choose_device(infos(devices), "")];
}

std::vector<DeviceInfo> infos(const std::vector<FoundDevice>& devices) {
  std::vector<DeviceInfo> result;
  result.reserve(devices.size());
  for (const FoundDevice& device : devices) result.push_back(device.physical.info);
  return result;
}

}  // namespace simvis
