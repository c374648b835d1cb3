// Examines the Vulkan devices of a machine and chooses one of them.
#pragma once

#include <vulkan/vulkan.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <simvis/device_info.h>
#include <simvis/frame_plan.h>

namespace simvis {

struct PhysicalDevice {
  VkPhysicalDevice handle = VK_NULL_HANDLE;
  VkPhysicalDeviceProperties properties{};
  TargetLimits targets;
  double snap_px = 0, depth_snap_px = 0;  ///< see PassResult
  bool counts_invocations = false;        ///< supports pipeline statistics queries
  bool has_large_points = false;          ///< draws points as squares of more than a pixel
  double max_point_px = 1;                ///< the largest of these squares
  double point_step_px = 0;               ///< their sizes are rounded to multiples of this
  std::uint32_t max_draws = 1;            ///< most draws in one command (VK_EXT_multi_draw)
  std::uint32_t timestamp_bits = 0;       ///< of `queue_family`; 0 if it has no timestamps
  std::uint32_t queue_family = 0;  ///< for graphics and compute; meaningless if `info.unusable` says that there is none
  DeviceInfo info;

  /// Whether it is a rasteriser on the host's cores.
  bool is_cpu() const { return properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU; }
};

/// Queries the driver. `info.unusable` says why SimVis cannot run on the device. Throws MachineError if the driver
/// fails.
PhysicalDevice examine(VkPhysicalDevice handle);

/// Index of the device to use, see DeviceDesc::select. Throws InputError if `select` matches no device. Throws
/// MachineError, with the reason for each device, if no matching device is usable.
std::size_t choose_device(const std::vector<DeviceInfo>& devices, const std::string& select);

}  // namespace simvis
