// Concave meshes divided into convex pieces by HACD (Hierarchical Approximate Convex Decomposition; Mamou and Ghorbel,
// "A simple and efficient approach for 3D mesh approximate convex decomposition", 2009), which comes with Bullet's
// extras.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "elements/dynamics/world/world.h"

namespace simvis {

/// See DynamicsEngine::convex_pieces().
std::vector<CollisionShape> bullet_convex_pieces(std::span<const glm::dvec3> points,
                                                 std::span<const std::uint32_t> triangles, double concavity_m);

}  // namespace simvis
