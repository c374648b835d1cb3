// The part of solid shapes that lies below a plane, as water fills it.
#pragma once

#include <span>

#include "elements/dynamics/world/world.h"

namespace simvis {

struct SubmergedSolid {
  double volume_m3 = 0;
  glm::dvec3 center_m{0};  ///< centroid; the origin if nothing is submerged
};

/// The solid where dot(up, place) < level_m, in the frame of the body; `up` has unit length. Boxes, spheres and hulls
/// are exact up to rounding. Cylinders and capsules are integrated along their axis by 32 nodes, within 1e-8 of their
/// volume. Overlapping shapes count twice; a mesh or a plane has no volume and counts nothing.
SubmergedSolid submerged(std::span<const CollisionShape> shapes, const glm::dvec3& up, double level_m);

}  // namespace simvis
