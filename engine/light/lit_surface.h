// What light meets where a ray hits a surface.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include <simvis/draw_list.h>
#include <simvis/ray_caster.h>
#include "engine/light/surface_reflection.h"

namespace simvis {

/// Frames   that of the ray.
struct LitSurface {
  glm::dvec3 face{0};      ///< normal of the triangle or shape, unit length, towards the ray's origin
  double covered = 1;      ///< share of what lies behind that the surface covers, see Material
  glm::dvec3 emission{0};  ///< radiance that it sends to the ray's origin of its own; of an unlit surface all of it
  double reflected = 0;    ///< of what is covered: share of the light that is reflected as by a mirror
  glm::dvec3 passed{0};    ///< that passes straight through a pane of glass
  double matte = 1;        ///< that `reflection` gets; 0: the surface is unlit
  SurfaceReflection reflection{};
};

/// The surface at a hit of a ray from `origin_m` along `direction` (unit length). `list` is the one that the caster
/// knows, with `material` for the item in place of its own; `world_from_view` is the frame of both vectors.
///
/// Maps     normal, metallic-roughness and emissive; the occlusion map only concerns ambient light, which paths find.
/// Normals  those of the vertices and of the normal map, unless the ray does not see their side; a back side has them
///          turned. The back of a single-sided surface emits nothing.
LitSurface lit_surface(const DrawList& list, const Material& material, const glm::dmat4& world_from_view,
                       const glm::dvec3& origin_m, const glm::dvec3& direction, const RayHit& hit);

/// The radiance that a triangle of a mesh emits at a point.
glm::dvec3 emitted_radiance(const Material& material, const Mesh& mesh, std::uint32_t primitive,
                            const glm::dvec3& weights);

/// LitSurface::covered of a triangle of a mesh at a point.
double covered_share(const Material& material, const Mesh& mesh, std::uint32_t primitive, const glm::dvec3& weights);

}  // namespace simvis
