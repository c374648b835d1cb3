// Casts ray packets: trees of boxes are traversed in float32, and the triangles that are reached are tested in double,
// see ray_caster.h.
#pragma once

#include <cstdint>

#include "engine/geometry/wide_bvh.h"
#include "engine/raycast/closest_hit.h"
#include "engine/raycast/ray_packet.h"

namespace simvis {

/// Updates the packet's nearest hits with all items; `items` is a tree over their boxes.
void traverse_packet(RayView& view, const WideBvh& items, RayPacket& packet);

/// The same for a packet whose rays have origins of their own.
void traverse_from_origins(RayView& view, const WideBvh& items, RayPacket& packet);

/// Updates the packet's nearest hits with one item.
void traverse_packet(RayView& view, std::uint32_t placed, RayPacket& packet);

/// Updates the packet's nearest hits with one triangle of an item.
void try_triangle(RayView& view, std::uint32_t placed, std::uint32_t primitive, RayPacket& packet);

}  // namespace simvis
