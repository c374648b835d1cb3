// Judging and choosing among the Vulkan devices of a machine.
#pragma once

#include <vulkan/vulkan.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <simvis/device.h>

namespace simvis {

struct PhysicalDevice {
  VkPhysicalDevice handle = VK_NULL_HANDLE;
  VkPhysicalDeviceProperties properties{};
  TargetLimits targets;
  double snap_px = 0, depth_snap_px = 0;  ///< see PassResult
  bool counts_invocations = false;        ///< has pipeline statistics
  std::uint32_t max_draws = 1;            ///< by one command (VK_EXT_multi_draw)
  std::uint32_t timestamp_bits = 0;       ///< of `queue_family`; 0: it has no clock
  std::uint32_t queue_family = 0;         ///< with graphics and compute; meaningless when `info.unusable` says so
  DeviceInfo info;
};

/// Asks the driver and judges: `info.unusable` tells why SimVis cannot run on it.
PhysicalDevice examine(VkPhysicalDevice handle);

/// The index of the device to take, see DeviceDesc::select.
/// Throws InputError when `select` matches none, MachineError with each device's reason when none that it matches fits.
std::size_t choose_device(const std::vector<DeviceInfo>& devices, const std::string& select);

}  // namespace simvis
