// Selection and ownership of a Vulkan device.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <simvis/device_info.h>
#include <simvis/export.h>
#include <simvis/frame_plan.h>

namespace simvis {

struct DeviceImpl;

/// All Vulkan devices of this machine, in the driver's order. Those of the driver that SimVis was built with come last.
///
/// Errors   MachineError if there is no Vulkan loader or driver; the message says what to install.
SIMVIS_API std::vector<DeviceInfo> list_devices();

/// A Vulkan device. All objects of this class in a process that are made with the same choice (`select`, `validation`,
/// `instrumented`, cache folder) share one logical device, its pipelines and its queue, which is closed with the last
/// of them. Memory, buffers and submissions are their own.
///
/// Environment  SIMVIS_VALIDATION=1 enables the validation layer too; each of its messages is printed to stderr and
///              counted. SIMVIS_MAX_WAIT_S: seconds, from 0.001 to 1000000, that the device may take for one
///              submission of work, 600 by default. Time in which the process is stopped does not count.
/// Errors       the constructor throws MachineError with the reason per device if none fits, and InputError if
///              `select` matches no device.
/// Lifetime     renderers and ray casters that use the device must be destroyed before it.
/// Threads      one thread at a time. Several objects may be used in several threads, also if they share a device.
class SIMVIS_API Device {
 public:
  /// Selects and opens a device. `threads` as SimulationDesc::threads.
  explicit Device(const DeviceDesc& desc = {}, unsigned threads = 0);
  ~Device();  ///< the last one of a choice saves the pipeline cache
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  const DeviceInfo& info() const;             ///< valid as long as the device
  bool is_cpu() const;                        ///< the device is a rasteriser on the host's cores
  const TargetLimits& target_limits() const;  ///< valid as long as the device

  /// Bytes of device memory that the buffers and images of this object's users take at present.
  std::uint64_t memory_bytes() const;

  /// Errors and warnings of the validation layer since this object was made, also those that others caused with whom it
  /// shares the device (0 if the layer is off).
  std::uint64_t validation_messages() const;

  DeviceImpl& impl() { return *impl_; }  ///< for the library itself

 private:
  std::unique_ptr<DeviceImpl> impl_;
};

}  // namespace simvis
