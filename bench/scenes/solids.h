// Solids cut into as many triangles as one likes: furniture for labs of any size.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>

#include <simvis/mesh.h>

namespace simvis::bench {

/// Each is centred at the origin, closed, with normals, and has about `triangles` triangles: as near as its grid comes.
Mesh box_of(const glm::dvec3& size_m, double triangles);
Mesh sphere_of(double radius_m, double triangles);
/// About z; the ends are fans.
Mesh cylinder_of(double radius_m, double height_m, double triangles);
/// A rectangle in the plane z = 0 that looks along +z; not closed.
Mesh wall_of(const glm::dvec2& size_m, double triangles);

}  // namespace simvis::bench
