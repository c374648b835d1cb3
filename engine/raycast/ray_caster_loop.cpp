// Apart from ray_caster.cpp, so that programs without Vulkan can link ray casters of the host.
#include <simvis/ray_caster.h>

namespace simvis {

void RayCaster::parallel_for(std::size_t count, std::size_t, const LoopBody& body) {
  if (count > 0) body(0, 0, count);
}

}  // namespace simvis
