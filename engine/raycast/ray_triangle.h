// Whether and where a ray from the origin meets a triangle, in double, watertight.
//
// Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013, with signs that are exact: corners
// are sheared so that the ray runs along one axis; then the ray meets the triangle if the origin of the plane across
// lies in the sheared triangle, edges included. A corner's sheared place depends on nothing but the corner and the ray,
// and on which side of an edge the origin lies is decided without rounding. So triangles that share vertices share
// borders, and no ray passes between them.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>

#include <simvis/mesh.h>

namespace simvis {

/// A mesh in the frame of a sensor: point = linear * p + offset.
struct MeshPlacement {
  glm::dmat3 linear{1.0};
  glm::dvec3 offset{0};
};

/// `world_from_sensor` is rigid. Places far from the world's origin are subtracted before anything else.
MeshPlacement place_mesh(const glm::dmat4& world_from_mesh, const glm::dmat4& world_from_sensor);

/// The corners of a primitive in the sensor frame.
std::array<glm::dvec3, 3> place_corners(const Mesh& mesh, std::uint32_t primitive, const MeshPlacement& placement);

/// A ray from the origin along a unit vector.
struct ShearedRay {
  int x = 0, y = 1, z = 2;                     ///< z: the largest component of the direction
  double shear_x = 0, shear_y = 0, per_z = 1;  ///< range along the ray = per_z * z

  ShearedRay() = default;
  explicit ShearedRay(const glm::dvec3& direction);
};

struct TriangleHit {
  double range_m = 0;
  glm::dvec3 weights{0};  ///< of the corners, of one sign, not normalised: their sum is the sheared area, doubled
};

/// False where the ray misses, meets the triangle edge-on, or at no positive range.
bool intersect(const ShearedRay& ray, const std::array<glm::dvec3, 3>& corners, TriangleHit& hit);

/// How far a hit's range may be off when each corner may be displaced by `corner_error_m`. See ray_caster.h.
double range_error_bound(const ShearedRay& ray, const std::array<glm::dvec3, 3>& corners, const TriangleHit& hit,
                         double corner_error_m);

}  // namespace simvis
