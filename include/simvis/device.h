// Selection and ownership of a Vulkan device.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <simvis/export.h>
#include <simvis/frame_plan.h>
#include <simvis/progress.h>

namespace simvis {

/// A Vulkan device of this machine, as known before one is selected.
struct DeviceInfo {
  std::string name;         ///< the driver's name for the device
  std::string type;         ///< "discrete GPU", "integrated GPU", "virtual GPU", "CPU" or "other"
  std::string driver;       ///< driver name and version text
  std::string api_version;  ///< "1.3.230"
  std::string unusable;     ///< empty, or why SimVis cannot run on it
};

/// All Vulkan devices of this machine, in the driver's order.
///
/// Errors   MachineError if there is no Vulkan loader or driver; the message says what to install.
SIMVIS_API std::vector<DeviceInfo> list_devices();

/// How a device is selected and used.
struct DeviceDesc {
  std::string select;       ///< part of a name (any case) or an index of list_devices(); empty: the best device
                            ///< (discrete before integrated before virtual before CPU)
  bool validation = false;  ///< enables the Khronos validation layer and counts its errors and warnings
  std::string cache_dir;    ///< folder of caches; empty: $XDG_CACHE_HOME/simvis or ~/.cache/simvis
  /// Measures times and counts on the device, see FrameCosts. No result depends on it. Without it no query is recorded.
  bool instrumented = false;
  ProgressCallback progress{};  ///< called while meshes are prepared for drawing
};

/// A logical Vulkan device with one queue.
///
/// Environment  SIMVIS_VALIDATION=1 enables the validation layer too; each of its messages is printed to stderr and
///              counted.
/// Errors       the constructor throws MachineError with the reason per device if none fits, and InputError if
///              `select` matches no device.
/// Lifetime     renderers and ray casters that use the device must be destroyed before it.
/// Threads      one thread at a time. Several devices may be used in several threads.
class SIMVIS_API Device {
 public:
  /// Selects and opens a device. `threads` as SimulationDesc::threads.
  explicit Device(const DeviceDesc& desc = {}, unsigned threads = 0);
  ~Device();  ///< waits for the device and saves the pipeline cache
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  const DeviceInfo& info() const;             ///< valid as long as the device
  bool is_cpu() const;                        ///< the device is a rasteriser on the host's cores
  const TargetLimits& target_limits() const;  ///< valid as long as the device

  /// Bytes of device memory that all buffers and images of SimVis take at present.
  std::uint64_t memory_bytes() const;

  /// Errors and warnings of the validation layer since the device was made (0 if the layer is off).
  std::uint64_t validation_messages() const;

  struct Impl;
  Impl& impl() { return *impl_; }  ///< for the library itself

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace simvis
