// Converts Assimp's meshes to SimVis meshes.
#pragma once

#include <vector>

#include <simvis/mesh.h>
#include "import/programs/assimp_file.h"

namespace simvis {

/// Positions and normals are those of the file, with normals scaled to unit length. A corner whose normal is missing,
/// zero or not finite gets the normal of its face. Texture coordinates are converted to v down, and vertex colours from
/// sRGB to linear. Polygons are cut into triangles. Vertices with equal bits are merged. Returns at most one mesh of
/// triangles, one of lines and one of points; no mesh is empty. With `faces` only those of which it holds are
/// converted. Texture coordinates that are not finite become 0 0, and colours white, with a warning. Throws InputError
/// for positions that are not finite, for more than 2^32 - 1 corners in total, and for more than kMaxPolygonCorners
/// corners in one face.
std::vector<Mesh> convert_mesh(AssimpFile& file, const aiMesh& source, const std::vector<bool>* faces = nullptr);

}  // namespace simvis
