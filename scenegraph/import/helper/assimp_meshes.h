// Meshes of Assimp's as ours.
#pragma once

#include <vector>

#include <simvis/mesh.h>
#include "scenegraph/import/helper/assimp_file.h"

namespace simvis {

/// Positions and normals as in the file (normals brought to unit length); a corner whose normal is missing, zero or not
/// finite gets that of its face. Texture coordinates are turned to v down, vertex colours from sRGB to linear.
/// Polygons are cut into triangles. Vertices that are equal to the last bit are joined. At most one mesh of triangles,
/// one of lines and one of points; none is empty.
/// Throws InputError: positions, texture coordinates or colours that are not finite, more than 2^32 - 1 corners in all
/// or kMaxPolygonCorners in a face.
std::vector<Mesh> convert_mesh(AssimpFile& file, const aiMesh& source);

}  // namespace simvis
