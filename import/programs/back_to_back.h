// Faces that lie back to back: two faces with the same corners, seen from opposite sides, in different materials.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <vector>

namespace simvis {

/// A mesh of a node. corners(face, corners) adds the corners of a face, in its order.
struct FacedMesh {
  std::uint32_t material = 0;
  std::size_t faces = 0;
  std::function<void(std::size_t face, std::vector<glm::vec3>& corners)> corners;
};

/// SketchUp writes each face twice, once for its front and once for its back, with a material each. Programs that show
/// only the fronts of faces, as Gazebo does, show the right one from either side. With both visible from both sides, it
/// would be left to rounding which one is seen.
/// Returns for each of the node's meshes that has such faces which of its faces they are.
std::map<std::size_t, std::vector<bool>> faces_back_to_back(const std::vector<FacedMesh>& meshes);

}  // namespace simvis
