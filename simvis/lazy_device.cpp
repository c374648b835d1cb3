#include "simvis/lazy_device.h"

#include <utility>

#include "engine/base/cache_file.h"
#include "engine/vulkan/gpu_node.h"

namespace simvis {

LazyDevice::LazyDevice(DeviceDesc desc, unsigned threads) : desc_(std::move(desc)), threads_(threads) {
  if (!desc_.select.empty() || desc_.instrumented) open();
}

Device& LazyDevice::open() {
  if (!device_) device_.emplace(desc_, threads_);
  return *device_;
}

std::unique_ptr<RayCaster> LazyDevice::host_caster() const {
  return make_host_ray_caster(cache_folder(desc_.cache_dir), threads_);
}

std::unique_ptr<RayCaster> LazyDevice::caster() {
  return device_ || has_gpu_node() ? make_ray_caster(open()) : host_caster();
}

}  // namespace simvis
