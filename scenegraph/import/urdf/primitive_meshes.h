// Meshes of simple solids, closed, wound counter-clockwise from outside, with texture coordinates 0..1 on every side.
#pragma once

#include <glm/glm.hpp>

#include <simvis/mesh.h>

namespace simvis {

/// Cylinders and spheres have this many sides around. A flat side lies up to 0.13 % of the radius inside the round one
/// (1 - cos(180 / 60 degrees)).
inline constexpr int kSidesAround = 60;

/// Centred at the origin; `size_m` along x, y, z, above 0. Flat normals.
Mesh box_mesh(const glm::dvec3& size_m);

/// About z, centred at the origin. Smooth around, flat at the ends.
Mesh cylinder_mesh(double radius_m, double length_m);

/// Centred at the origin, kSidesAround around and half as many from pole to pole. Smooth.
Mesh sphere_mesh(double radius_m);

}  // namespace simvis
