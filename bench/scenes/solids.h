// Solids with a given number of triangles, as furniture for labs of any size.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>

#include <simvis/mesh.h>

namespace simvis::bench {

/// Each solid is centred at the origin, closed, has normals and about `triangles` triangles, as close as its grid
/// allows.
Mesh box_of(const glm::dvec3& size_m, double triangles);
Mesh sphere_of(double radius_m, double triangles);
/// The axis is z; the ends are triangle fans.
Mesh cylinder_of(double radius_m, double height_m, double triangles);
/// A rectangle in the plane z = 0 that faces +z; not closed.
Mesh wall_of(const glm::dvec2& size_m, double triangles);

}  // namespace simvis::bench
