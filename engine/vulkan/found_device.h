// Finds the devices of the system's Vulkan drivers and of the driver that SimVis brings along, and selects one.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "engine/vulkan/instance.h"
#include "engine/vulkan/physical_device.h"

namespace simvis {

/// A device with the instance that has loaded its driver.
struct FoundDevice {
  std::shared_ptr<Instance> instance;
  PhysicalDevice physical;
};

/// The JSON file (Vulkan's ICD manifest) of the driver that was built for SimVis and lies beside the library, as in a
/// wheel; empty: there is none.
std::filesystem::path bundled_driver();

/// All devices of the system's drivers, in their order, and then those of the driver `bundled`, which say so in
/// DeviceInfo::driver. Never empty: throws MachineError as Instance.
std::vector<FoundDevice> find_devices(bool validation, const std::filesystem::path& bundled);

/// The device of DeviceDesc::select. Throws as find_devices() and choose_device(), and InputError if a bundled driver
/// is asked for and `bundled` is empty.
FoundDevice find_device(bool validation, const std::string& select, const std::filesystem::path& bundled);

std::vector<DeviceInfo> infos(const std::vector<FoundDevice>& devices);

}  // namespace simvis
