// Converts Assimp's meshes to SimVis meshes.
#pragma once

#include <vector>

#include <simvis/mesh.h>
#include "import/programs/assimp_file.h"

namespace simvis {

/// Returns what polygon_meshes.h makes of the faces, or of the vertices as points if there are no faces. With `faces`
/// only those of which it holds are converted.
std::vector<Mesh> convert_mesh(AssimpFile& file, const aiMesh& source, const std::vector<bool>* faces = nullptr);

}  // namespace simvis
