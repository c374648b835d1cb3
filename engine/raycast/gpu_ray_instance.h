// An item as ray_cast.comp reads it, and the error bounds of a ray in the item's unit frame.
//
// The shader transforms a ray into the unit frame in float32 (e = 2^-23; ray_cast.comp states the error of each
// operation). Let D be the distance of the sensor in radii, and k the condition number of the mesh's transform (the
// product of the Frobenius norms of the matrix and its inverse). Over a length of up to D + 6 radii the errors are:
//   position of the sensor    7 e k D   (difference 2, row 0.5, product of three 3, scale 1.5)
//   start of the ray            e (D + 3)
//   direction of the ray      (4 e k + 2 e) (D + 6): row 0.5, direction 0.5, product of three 3; then normalisation
//   length of the direction   5 e (D + 6)
// Their sum is e ((11 k + 8) D + 24 k + 45). The inverse matrix is computed in double with a relative error E. This
// adds D E to the position and (D + 6) E to the direction. Each position is stored as two floats. 2^-44 times the sum
// of all lengths involved covers this rounding and the roundings in double. A range along the ray is the length in the
// unit frame divided by the length of one metre there. Its relative error is e (4 k + 9) + E; the code uses 16 instead
// of 9, which leaves room for the shader's other operations.
#pragma once

#include "engine/raycast/ray_instances.h"
#include "shaders/interop.h"

namespace simvis {

/// The contents of GpuRayInstance::tree.
struct GpuRayInstanceTree {
  std::uint32_t root = 0, first_triangle = 0;
  bool solid = false, has_back = false;
};

/// `origin` is RayInstances::origin(), in the world frame.
shader::GpuRayInstance block_of(const RayInstance& item, const glm::dvec3& origin, const GpuRayInstanceTree& tree);

/// Push constants for a cast of `rays` rays from `world_sensor`.
shader::RayCastBlock block_of(const glm::dvec3& world_sensor, const glm::dvec3& origin, std::uint32_t rays,
                              HitSides sides);

}  // namespace simvis
