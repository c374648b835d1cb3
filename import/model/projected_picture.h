// Texture coordinates of a picture that is projected over a box.
#pragma once

#include <glm/glm.hpp>

#include <simvis/mesh.h>

namespace simvis {

/// The mesh with the texture coordinates of a picture that is projected along z over a box, whose upper left corner is
/// at x = -1, y = 1. `box_from_mesh` places the mesh so that the box's sides are at -1 and 1.
Mesh with_projected_picture(Mesh mesh, const glm::dmat4& box_from_mesh);

}  // namespace simvis
