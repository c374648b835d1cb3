// The results of ray packets that were cast: the bounds of their hits are computed for four rays at once.
#pragma once

#include <simvis/ray_caster.h>
#include "engine/raycast/closest_hit.h"
#include "engine/raycast/ray_packet.h"

namespace simvis {

/// Writes the nearest hit of each ray of any packet, with its error bound: hits[i] belongs to ray i.
void finish_packet(RayView& view, const RayPacket& packet, RayHit* hits);

}  // namespace simvis
