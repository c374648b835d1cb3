// The surface at the point where a ray hits it.
#pragma once

#include <glm/glm.hpp>

#include <simvis/draw_list.h>
#include <simvis/export.h>
#include <simvis/ray_caster.h>

namespace simvis {

/// The surface at a hit.
struct SurfacePoint {
  double range_m = 0;           ///< range along the ray from its origin, as in RayHit
  double error_bound_m = 0;     ///< of range_m
  glm::dvec3 normal{0};         ///< of the triangle or shape: unit length, sensor frame, facing the ray's origin;
                                ///< at a Gaussian splat, which has no surface, opposite to the ray
  double normal_error_rad = 0;  ///< largest rotation of the normal by rounding
  glm::vec4 base_color{1};      ///< linear: material x vertex colour x texture at its largest level
  const Material* material = nullptr;  ///< of the draw list, valid as long as the list is unchanged
  std::uint32_t item = 0,              ///< in DrawList::items
      primitive = 0;                   ///< in the item's mesh, or the face of its shape
};

/// The surface at a hit. A caster must have returned `hit` for a ray from the sensor's origin along `direction` (unit
/// length, sensor frame) into this draw list (asserted). `world_from_sensor` is rigid.
///
/// Threads  any number at a time.
SIMVIS_API SurfacePoint surface_point(const DrawList& list, const glm::dmat4& world_from_sensor,
                                      const glm::dvec3& direction, const RayHit& hit);

}  // namespace simvis
