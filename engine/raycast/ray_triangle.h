// Watertight intersection of a ray from the origin with a triangle, in double.
//
// The method is that of Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013, with exact
// signs. The corners are sheared so that the ray runs along one axis. The ray then hits the triangle if the origin of
// the plane perpendicular to that axis lies in the sheared triangle, edges included. The sheared position of a corner
// depends only on the corner and the ray, and the side of an edge on which the origin lies is decided without rounding.
// Triangles that share vertices therefore share borders, and no ray passes between them.
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

/// `world_from_sensor` is rigid. The two positions, which may be far from the world's origin, are subtracted before any
/// other operation.
MeshPlacement place_mesh(const glm::dmat4& world_from_mesh, const glm::dmat4& world_from_sensor);

/// The corners of a primitive in the sensor frame.
std::array<glm::dvec3, 3> place_corners(const Mesh& mesh, std::uint32_t primitive, const MeshPlacement& placement);

/// Four vertices in the sensor frame, to the bit as corners.
std::array<glm::dvec3, 4> place_vertices(const Mesh& mesh, const std::array<std::uint32_t, 4>& vertices,
                                         const MeshPlacement& placement);

/// A ray from the origin along a unit vector.
struct ShearedRay {
  int x = 0, y = 1, z = 2;                     ///< z: the largest component of the direction
  double shear_x = 0, shear_y = 0, per_z = 1;  ///< range along the ray = per_z * z

  ShearedRay() = default;
  explicit ShearedRay(const glm::dvec3& direction);
};

struct TriangleHit {
  double range_m = 0;
  /// Weights of the corners, all of one sign, not normalised: their sum is twice the sheared area.
  glm::dvec3 weights{0};
};

/// Returns false if the ray misses the triangle, meets it edge-on, or meets it at a range that is not positive.
bool intersect(const ShearedRay& ray, const std::array<glm::dvec3, 3>& corners, TriangleHit& hit);

/// Whether a ray that hits a triangle sees its corners clockwise, and so its back; `mirrored` turns the winding round.
/// `area` is the sum of the weights of the hit. Its sign is exact: the cross product of the sheared corners is the
/// component along the ray of the triangle's normal, over the largest component of the direction.
inline bool shows_back(const ShearedRay& ray, double area, bool mirrored) {
  return ((area > 0) == (ray.per_z > 0)) != mirrored;
}

/// Error bound of a hit's range if each corner is displaced by up to `corner_error_m`. See ray_caster.h.
double range_error_bound(const ShearedRay& ray, const std::array<glm::dvec3, 3>& corners, const TriangleHit& hit,
                         double corner_error_m);

}  // namespace simvis
