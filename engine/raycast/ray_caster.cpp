#include <simvis/ray_caster.h>

#include <simvis/device.h>
#include "engine/base/thread_pool.h"
#include "engine/vulkan/device_impl.h"

namespace simvis {

void RayCaster::parallel_for(std::size_t count, std::size_t, const LoopBody& body) {
  if (count > 0) body(0, 0, count);
}

std::unique_ptr<RayCaster> make_ray_caster(Device& device) {
  if (device.is_cpu()) return make_host_ray_caster(device.impl().cache_folder, device.impl().threads->size());
  return make_device_ray_caster(device);
}

}  // namespace simvis
