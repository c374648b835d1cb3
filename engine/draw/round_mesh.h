// Meshes of flat sides that stand for round shapes.
#pragma once

#include <simvis/mesh.h>

namespace simvis {

/// The number of flat sides around the mesh that stands for a round shape where no view asks for another one. Its
/// points lie inside of the shape by at most 0.14 % of the radius of a cylinder or a cone, and 0.28 % of that of a
/// sphere.
inline constexpr int kSidesAround = 60;

/// A closed mesh inside of a round shape: all its vertices lie on the shape, counter-clockwise seen from outside, with
/// the normals of the shape and texture coordinates 0..1 on every side (set 1: see round_texture.h). `shape` is no
/// plane; its `deviation_m` is not read. `sides` flat sides around it, a multiple of 4, and half as many from pole to
/// pole of a sphere. The mesh has the shape, with its own deviation, as its `surface`.
Mesh round_mesh(const ExactSurface& shape, int sides);

/// An upper bound on the distance of any point of a shape of radius 1 from that mesh, without the rounding of vertices:
///   cylinder, cone     1 - cos(180 degrees / sides),
///   sphere, capsule    1 - sqrt(cos(360 degrees / sides)), in the middle of a diagonal at the equator.
double deviation_at_radius_1(SurfaceKind kind, int sides);

/// The same of any shape, in metres, with the rounding of vertices. `at_radius_1` as above.
double deviation_of_round_mesh(const ExactSurface& shape, double at_radius_1);

}  // namespace simvis
