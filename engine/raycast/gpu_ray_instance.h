// An item as ray_cast.comp reads it, and how exactly its unit frame is found there.
//
// The shader brings a ray's line into the unit frame in float32 (e = 2^-23; see ray_cast.comp for what an operation may
// be off by). Let D be the sensor's distance in radii, k the condition of the mesh's transform (product of the
// Frobenius norms of it and its inverse), over a way of up to D + 6 radii:
//   the sensor's place      7 e k D   (difference 2, row 0.5, product of three 3, scale 1.5)
//   the ray's start           e (D + 3)
//   the ray's direction     (4 e k + 2 e) (D + 6): row 0.5, direction 0.5, product of three 3; then made a unit vector
//   its length              5 e (D + 6)
// in all e ((11 k + 8) D + 24 k + 45). The inverse itself, formed in double, is off by a share of E: D E for the place
// and (D + 6) E for the direction. Places are rounded to two floats each: 2^-44 of all lengths in play covers that, and
// what double rounds. A range, which is way over the length that a metre has there, is off by a share of
// e (4 k + 9) + E; 16 instead of 9 leave room for the shader's bookkeeping.
#pragma once

#include "engine/raycast/ray_instances.h"
#include "shaders/interop.h"

namespace simvis {

/// What stands in RayItem::tree.
struct RayItemTree {
  std::uint32_t root = 0, first_triangle = 0;
  bool solid = false;
};

/// `origin` is the top tree's, in the world.
shader::RayItem block_of(const RayInstance& item, const glm::dvec3& origin, const RayItemTree& tree);

/// For a cast of so many rays.
shader::RayCastBlock block_of(const glm::dvec3& world_sensor, const glm::dvec3& origin, std::uint32_t rays);

}  // namespace simvis
