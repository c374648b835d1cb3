// The tree of a glTF file's nodes and where each node stands.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "scenegraph/import/gltf/gltf_document.h"
#include "scenegraph/part_animation.h"

namespace simvis {

/// Frames   glTF's: y up. All matrices are finite.
struct GltfHierarchy {
  std::vector<int> roots;                    ///< of the scene that is imported
  std::vector<int> order;                    ///< every node of the file, parents before children
  std::vector<int> parents;                  ///< for each node of the file; -1: none
  std::vector<glm::dmat4> parent_from_node;  ///< for each node of the file
  std::vector<glm::dmat4> root_from_node;    ///< likewise
};

/// The default scene, or else scene 0, or else all nodes without parents.
/// Throws InputError: a node with two parents, a cycle, a scene root that is some node's child, a rotation that is not
/// a unit quaternion, a matrix that is not affine, products of matrices that are not finite.
GltfHierarchy read_hierarchy(const GltfDocument& document);

/// Where a node without a matrix stands in its parent's frame. Throws InputError as read_hierarchy().
LocalPose read_local_pose(const GltfDocument& document, std::size_t node);

/// The unit quaternion nearest to x, y, z, w, if that is one but for rounding.
std::optional<glm::dvec4> unit_quaternion(const glm::dvec4& q);

/// One matrix per instance of EXT_mesh_gpu_instancing, node_from_instance; empty when the node has none.
std::vector<glm::dmat4> read_instances(const GltfDocument& document, int node);

/// joint_from_mesh of each joint of a skin. Throws InputError for matrices that do not fit.
std::vector<glm::dmat4> read_inverse_bind_matrices(const GltfDocument& document, int skin);

/// One matrix per joint of a skin, root_from_mesh. Throws InputError as read_inverse_bind_matrices().
std::vector<glm::dmat4> read_joint_matrices(const GltfDocument& document, const GltfHierarchy& hierarchy, int skin);

}  // namespace simvis
