// Takes bundles of rays through trees of boxes, in float32, to the triangles that they may meet; whether and where they
// do is decided in double, see ray_caster.h.
#pragma once

#include <cstdint>

#include "engine/geometry/wide_bvh.h"
#include "engine/raycast/nearest_hit.h"
#include "engine/raycast/ray_bundle.h"

namespace simvis {

/// Brings the bundle's nearest hits up to date with all items; `items` is a tree over their boxes.
void walk_bundle(RayView& view, const WideBvh& items, RayBundle& bundle);

/// The same with one item alone.
void walk_bundle(RayView& view, std::uint32_t placed, RayBundle& bundle);

/// The same with one triangle of an item.
void try_triangle(RayView& view, std::uint32_t placed, std::uint32_t primitive, RayBundle& bundle);

/// What each ray has met, with its bound: hits[i] is ray i's.
void finish_bundle(RayView& view, const RayBundle& bundle, RayHit* hits);

}  // namespace simvis
