// Takes bundles of rays through trees of boxes, in float32, to the triangles that they may meet; whether and where they
// do is decided in double, see ray_caster.h.
#pragma once

#include <cstdint>

#include "engine/geometry/wide_bvh.h"
#include "engine/raycast/closest_hit.h"
#include "engine/raycast/ray_packet.h"

namespace simvis {

/// Brings the bundle's nearest hits up to date with all items; `items` is a tree over their boxes.
void walk_bundle(RayView& view, const WideBvh& items, RayPacket& packet);

/// The same with one item alone.
void walk_bundle(RayView& view, std::uint32_t placed, RayPacket& packet);

/// The same with one triangle of an item.
void try_triangle(RayView& view, std::uint32_t placed, std::uint32_t primitive, RayPacket& packet);

/// What each ray has met, with its bound: hits[i] is ray i's.
void finish_bundle(RayView& view, const RayPacket& packet, RayHit* hits);

}  // namespace simvis
