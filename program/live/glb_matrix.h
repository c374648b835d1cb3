// Transforms as glTF's nodes hold them.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

namespace simvis::live {

/// The matrices of a chain of glTF nodes, the outer one first, whose product is `matrix`. A glTF node has a
/// translation, a rotation and a scale, so a matrix that shears becomes two nodes. Empty: the matrix is of no size, and
/// no node shows anything.
std::vector<glm::dmat4> gltf_nodes_of(const glm::dmat4& matrix);

/// A rotation that turns -z, along which lights of glTF shine, to `direction`, a unit vector.
glm::dmat4 turn_of_light(const glm::dvec3& direction);

}  // namespace simvis::live
