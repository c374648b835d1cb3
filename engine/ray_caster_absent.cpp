// Stands in for the ray caster on the host where SimVis is built without Embree.
#include "engine/ray_caster.h"

namespace simvis {

bool has_host_ray_caster() { return false; }
std::unique_ptr<RayCaster> make_host_ray_caster() { return nullptr; }

}  // namespace simvis
