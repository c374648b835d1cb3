#include <simvis/ray_caster.h>

#include <simvis/device.h>
#include "engine/base/thread_pool.h"
#include "engine/vulkan/device_impl.h"

namespace simvis {

std::unique_ptr<RayCaster> make_ray_caster(Device& device) {
  if (device.is_cpu()) return make_host_ray_caster(device.impl().cache_folder, device.impl().threads->size());
  return make_device_ray_caster(device);
}

}  // namespace simvis
