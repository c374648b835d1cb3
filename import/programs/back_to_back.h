// Faces that lie back to back: two faces with the same corners, seen from opposite sides, in different materials.
#pragma once

#include <assimp/scene.h>

#include <map>
#include <vector>

namespace simvis {

/// SketchUp writes each face twice, once for its front and once for its back, with a material each. Programs that show
/// only the fronts of faces, as Gazebo does, show the right one from either side. With both visible from both sides, it
/// would be left to rounding which one is seen.
/// Returns for each of the node's meshes that has such faces which of its faces they are.
std::map<unsigned, std::vector<bool>> faces_back_to_back(const aiScene& scene, const aiNode& node);

}  // namespace simvis
