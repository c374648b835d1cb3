// The tree of a glTF file's nodes and the pose of each node.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "import/gltf/gltf_document.h"
#include "scenegraph/part_animation.h"

namespace simvis {

/// Frames   glTF frames, with y up. All matrices are finite.
struct GltfHierarchy {
  std::vector<int> roots;                    ///< roots of the imported scene
  std::vector<int> order;                    ///< every node of the file, parents before children
  std::vector<int> parents;                  ///< for each node of the file; -1: none
  std::vector<glm::dmat4> parent_from_node;  ///< for each node of the file
  std::vector<glm::dmat4> root_from_node;    ///< for each node of the file
};

/// Reads the default scene, or else scene 0, or else all nodes without parents.
/// Takes a node with two parents from the second, and a node that is both a root and a child for one of them, each with
/// a warning. Throws InputError for a cycle, a root that the scene has twice, a rotation that is not a unit quaternion,
/// a matrix that is not affine, and products of matrices that are not finite.
GltfHierarchy read_hierarchy(GltfDocument& document);

/// Returns the pose of a node without a matrix in its parent's frame. Throws InputError as read_hierarchy().
LocalPose read_local_pose(const GltfDocument& document, std::size_t node);

/// Returns the unit quaternion nearest to (x, y, z, w), or nothing if the length differs from 1 by more than rounding.
std::optional<glm::dvec4> unit_quaternion(const glm::dvec4& q);

/// Returns node_from_instance for each instance of EXT_mesh_gpu_instancing. Empty if the node has no instances.
std::vector<glm::dmat4> read_instances(const GltfDocument& document, int node);

/// Returns joint_from_mesh for each joint of a skin. Throws InputError if there are too few matrices.
std::vector<glm::dmat4> read_inverse_bind_matrices(const GltfDocument& document, int skin);

/// Returns root_from_mesh for each joint of a skin. Throws InputError as read_inverse_bind_matrices().
std::vector<glm::dmat4> read_joint_matrices(const GltfDocument& document, const GltfHierarchy& hierarchy, int skin);

}  // namespace simvis
