// A ray that leaves a surface which another ray has hit.
//
// Origin. The hit point P is off the triangle by rounding: by the bound b of the range, and by 8 u |P| for P's own
// coordinates and their transform to the world (u = 2^-53). The triangle is also transformed again relative to P, where
// its corners are off by less than 3 b. (A bound is at least the error of the corners, 28 u of the mesh's reach and
// distance and 21 u of the offsets from the world's origin, see ray_caster.h. From P the distance is within the reach,
// so 56 u reach and 21 u (2 |mesh| + reach) take their place, and |mesh| <= |sensor| + distance.) The sum of these
// errors divided by the cosine of the angle to the normal is the distance along the ray within which the ray can hit
// the same triangle again. The ray begins beyond twice that distance. A surface nearer than that, 1e-13 m in a room, is
// not hit from there.
#pragma once

#include <glm/glm.hpp>

#include <simvis/scan_effect.h>

namespace simvis {

/// The ray from the place where `ray` hit `surface`, along the unit vector `direction`. `cosine`, above 0, is that of
/// the angle between it and the normal. It has the share of `ray`, one turn more, and the error of its origin; those of
/// its way before and of its direction are for the caller.
inline BeamRay onward_ray(const BeamRay& ray, const SurfacePoint& surface, const glm::dvec3& direction, double cosine) {
  BeamRay onward = ray;
  onward.origin_m = ray.origin_m + surface.range_m * ray.direction;
  onward.direction = direction;
  onward.travelled_m = ray.travelled_m + surface.range_m;
  const double rounding_m = 8 * 0x1p-53 * glm::length(onward.origin_m);
  onward.origin_error_m = ray.origin_error_m + ray.error_rad * surface.range_m + rounding_m;
  onward.t_min_m = 2 * (5 * surface.error_bound_m + rounding_m) / cosine;
  ++onward.turns;
  return onward;
}

}  // namespace simvis
