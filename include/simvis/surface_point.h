// What a ray meets, besides how far away it is.
#pragma once

#include <glm/glm.hpp>

#include <simvis/draw_list.h>
#include <simvis/ray_caster.h>

namespace simvis {

struct SurfacePoint {
  double range_m = 0;                  ///< from the ray's origin, as RayHit
  double error_bound_m = 0;            ///< of it
  glm::dvec3 normal{0};                ///< of the triangle: unit length, sensor frame, against the ray
  double normal_error_rad = 0;         ///< by how much rounding may have turned it
  glm::vec4 base_color{1};             ///< linear: material x vertex colour x texture at its largest level
  const Material* material = nullptr;  ///< of the draw list
  std::uint32_t item = 0, primitive = 0;
};

/// Of a hit that a caster gave for a ray from the sensor's origin into this draw list. `world_from_sensor` is rigid.
SurfacePoint surface_point(const DrawList& list, const glm::dmat4& world_from_sensor, const glm::dvec3& direction,
                           const RayHit& hit);

}  // namespace simvis
