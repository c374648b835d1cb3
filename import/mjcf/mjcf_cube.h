// Cube textures: a picture on the six sides of a box.
#pragma once

#include <glm/glm.hpp>

#include <simvis/mesh.h>
#include "import/mjcf/mjcf_pictures.h"

namespace simvis {

/// The triangles of a mesh with the texture coordinates of a cube, whose sides show the same picture or squares of it
/// below each other, as OpenGL orients them: each triangle has the side in whose direction its middle lies, seen from
/// the cube's centre. `cube_from_mesh` places the mesh around the origin, where the cube's sides are at -1 and 1.
Mesh cube_textured(const Mesh& mesh, const glm::dmat4& cube_from_mesh, CubeSides sides);

}  // namespace simvis
