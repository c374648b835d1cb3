// Stands in for the ray caster where SimVis is built without Embree.
#include "engine/assert.h"
#include "engine/ray_caster.h"

namespace simvis {

struct RayCaster::Impl {};

bool RayCaster::available() { return false; }
RayCaster::RayCaster() = default;
RayCaster::~RayCaster() = default;
void RayCaster::set_world(const DrawList&) {}
void RayCaster::cast(const glm::dmat4&, std::span<const glm::dvec3>, std::span<RayHit>) { SIMVIS_ASSERT(available()); }
RayCounters RayCaster::counters() const { return {}; }

}  // namespace simvis
