// Choosing and owning a Vulkan device.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <simvis/progress.h>
#include <simvis/target_limits.h>

namespace simvis {

/// What is known of a Vulkan device before one is chosen.
struct DeviceInfo {
  std::string name;         ///< as the driver calls it
  std::string type;         ///< "discrete GPU", "integrated GPU", "virtual GPU", "CPU" or "other"
  std::string driver;       ///< driver name and version text
  std::string api_version;  ///< "1.3.230"
  std::string unusable;     ///< empty, or why SimVis cannot run on it
};

/// All Vulkan devices of this machine, in the driver's order.
/// Throws MachineError when there is no Vulkan loader or driver; the message says what to install.
std::vector<DeviceInfo> list_devices();

struct DeviceDesc {
  std::string select;       ///< part of a name (any case) or an index of list_devices(); empty: the best one
                            ///< (discrete before integrated before virtual before CPU)
  bool validation = false;  ///< turn the Khronos validation layer on; its errors and warnings are then counted
  std::string cache_dir;    ///< where caches lie; empty: $XDG_CACHE_HOME/simvis or ~/.cache/simvis
  /// Time and count what the device does, see FrameCosts. No result depends on it; without it nothing is asked of the
  /// device for this.
  bool instrumented = false;
  ProgressCallback progress{};  ///< hears of meshes that are made ready to be drawn
};

/// A logical device with one queue. Environment: SIMVIS_VALIDATION=1 turns validation on as well, and every message
/// of the layer is printed to stderr and counted.
/// Throws MachineError with the reason per device when none fits, InputError when `select` matches none.
class Device {
 public:
  /// `threads` as SimulationDesc::threads.
  explicit Device(const DeviceDesc& desc = {}, unsigned threads = 0);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  const DeviceInfo& info() const;
  bool is_cpu() const;  ///< rasterises on the host's own cores
  const TargetLimits& target_limits() const;

  /// Of the device's memory, what all buffers and images of SimVis take at present.
  std::uint64_t memory_bytes() const;

  /// Errors and warnings of the validation layer since the device was made (0 when the layer is off).
  std::uint64_t validation_messages() const;

  struct Impl;
  Impl& impl() { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace simvis
