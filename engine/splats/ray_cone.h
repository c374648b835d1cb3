// Cones around rays of pixels, and whether a splat can be seen in one.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "engine/splats/seen_splats.h"

namespace simvis {

/// A cone with its tip at the origin of V that holds rays.
struct RayCone {
  glm::dvec3 axis{0};  ///< V, unit length; zero: there is no ray
  double cosine = 1,   ///< of the angle between the axis and the sides
      sine = 0;
  bool is_wide = false;  ///< the angle is more than 86 degrees, and only the axis is set

  bool empty() const { return axis == glm::dvec3(0); }
};

/// The cone of rays of unit length; those of length zero are left out.
RayCone cone_of(std::span<const glm::dvec3> directions);

/// A cone that holds others.
RayCone cone_around(std::span<const RayCone> cones);

/// The rays that meet the splat's ellipsoid, and more of them.
RayCone cone_of(const SeenSplat& splat);

/// False only if no ray is in both cones. None of them is empty.
bool may_overlap(const RayCone& a, const RayCone& b);

/// False only if no ray in the cone meets the splat's ellipsoid. The cone is not empty.
bool may_meet(const RayCone& cone, const SeenSplat& splat);

}  // namespace simvis
