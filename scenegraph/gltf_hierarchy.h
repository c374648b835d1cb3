// The tree of a glTF file's nodes and where each node stands.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "scenegraph/gltf_document.h"

namespace simvis {

/// Frames   glTF's: y up. All matrices are finite.
struct GltfHierarchy {
  std::vector<int> roots;                    ///< of the scene that is imported
  std::vector<glm::dmat4> parent_from_node;  ///< for each node of the file
  std::vector<glm::dmat4> root_from_node;    ///< likewise
};

/// The default scene, or else scene 0, or else all nodes without parents.
/// Throws InputError: a node with two parents, a cycle, a scene root that is some node's child, a rotation that is not
/// a unit quaternion, a matrix that is not affine, products of matrices that are not finite.
GltfHierarchy read_hierarchy(const GltfDocument& document);

/// The matrix of translation * rotation * scale. `rotation` is a unit quaternion x, y, z, w.
glm::dmat4 trs_matrix(const glm::dvec3& translation, const glm::dvec4& rotation, const glm::dvec3& scale);

/// One matrix per instance of EXT_mesh_gpu_instancing, node_from_instance; empty when the node has none.
std::vector<glm::dmat4> read_instances(const GltfDocument& document, int node);

/// One matrix per joint of a skin, root_from_mesh. Throws InputError for inverse bind matrices that do not fit.
std::vector<glm::dmat4> read_joint_matrices(const GltfDocument& document, const GltfHierarchy& hierarchy, int skin);

}  // namespace simvis
