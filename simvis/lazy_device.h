// The device of a simulation. It is opened when something draws, or when rays are cast on a machine with a GPU: a
// driver with its compiler takes more time and memory to open than many runs need.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include <simvis/device.h>
#include <simvis/ray_caster.h>

namespace simvis {

/// Whether this machine may have a GPU, without a look at Vulkan's drivers: whether `dev` has a file of a driver of
/// GPUs, dri/renderD* (DRM), nvidia* or nvhost* (NVIDIA's), or dxg (WSL).
bool has_gpu_node(const std::filesystem::path& dev = "/dev");

class LazyDevice {
 public:
  /// Opens the device at once if `desc` selects one, so that a wrong name is an error, or wants it instrumented.
  /// `threads` as SimulationDesc::threads. Throws as Device.
  LazyDevice(DeviceDesc desc, unsigned threads);

  /// Opens it at the first call. Throws as Device.
  Device& open();
  /// Null while it is not open.
  const Device* opened() const { return device_ ? &*device_ : nullptr; }
  bool instrumented() const { return desc_.instrumented; }

  /// The caster on the host's cores, which needs no device.
  std::unique_ptr<RayCaster> host_caster() const;
  /// The faster caster of this machine. Opens the device only if the machine has a GPU. Throws as Device.
  std::unique_ptr<RayCaster> caster();

 private:
  DeviceDesc desc_;
  unsigned threads_;
  std::optional<Device> device_;
};

}  // namespace simvis
