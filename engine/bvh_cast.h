// Casts single rays through trees on the host, in double: exact, whatever the device left open.
#pragma once

#include "engine/bvh_mesh.h"
#include "engine/nearest_hit.h"

namespace simvis {

/// A ray from the sensor: a unit vector in the sensor frame, and the same prepared for triangles.
struct CastRay {
  explicit CastRay(const glm::dvec3& unit) : direction(unit), sheared(unit) {}
  glm::dvec3 direction;
  ShearedRay sheared;
};

/// Tests all triangles of an item that the ray may meet before `nearest`. Items are those of BvhMesh.
void cast_into_item(RayView& view, std::uint32_t placed, const CastRay& ray, NearestHit& nearest);

/// The same for all items; `items` is a tree over their boxes.
void cast_into_items(RayView& view, const Bvh& items, const CastRay& ray, NearestHit& nearest);

}  // namespace simvis
