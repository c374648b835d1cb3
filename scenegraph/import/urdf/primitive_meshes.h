// Closed meshes of simple solids, counter-clockwise seen from outside, with texture coordinates 0..1 on every side.
#pragma once

#include <glm/glm.hpp>

#include <simvis/mesh.h>

namespace simvis {

/// The number of flat sides around cylinders and spheres. A flat side lies up to 0.14 % of the radius inside the round
/// surface (1 - cos(180 / 60 degrees)).
inline constexpr int kSidesAround = 60;

/// A box with flat normals, centred at the origin. `size_m` is along x, y, z and above 0.
Mesh box_mesh(const glm::dvec3& size_m);

/// A cylinder along z, centred at the origin. Its normals are smooth around the axis and flat at the ends.
Mesh cylinder_mesh(double radius_m, double length_m);

/// A sphere with smooth normals, centred at the origin, with kSidesAround sides around and half as many from pole to
/// pole.
Mesh sphere_mesh(double radius_m);

}  // namespace simvis
