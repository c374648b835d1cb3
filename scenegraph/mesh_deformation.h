// Meshes that morph targets and joints deform, and the computation of their deformed shape.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include <simvis/mesh.h>

namespace simvis {

/// The displacement of each vertex at weight 1. Each vector is as long as the mesh's positions, or empty if the target
/// does not change that property.
struct MorphTarget {
  std::vector<glm::vec3> position_changes,  ///< metres, mesh frame
      normal_changes;                       ///< mesh frame
};

/// The influence of one joint on one vertex.
struct JointInfluence {
  std::uint32_t joint = 0;  ///< number of the joint in its skin
  float weight = 0;         ///< relative to the vertex's other weights
};

/// A mesh before deformation.
struct DeformableMesh {
  Mesh base;                         ///< its bounds are not set
  bool flat_normals = false;         ///< triangles have no normals of their own: each gets that of its deformed plane
  std::vector<MorphTarget> targets;  ///< morph targets
  std::size_t influences_per_vertex = 0;   ///< 0: no joints move it
  std::vector<JointInfluence> influences;  ///< vertex by vertex; the weights of each vertex have a sum above 0
};

/// Adds every morph target by its weight and then moves the mesh by its joints (linear blend skinning), in double with
/// one final rounding. The result has bounds. Normals stay perpendicular to their surfaces.
///
/// Shape    `weights` has one value per target, or is empty, which means zeros. `joint_matrices` (from the mesh's frame
///          to that of the result, affine) has one matrix per joint and is not read for a mesh without influences.
/// Special  returns an empty optional if the position of a vertex is not finite in float32.
std::optional<Mesh> deform(const DeformableMesh& source, std::span<const double> weights,
                           std::span<const glm::dmat4> joint_matrices);

/// Sets the data that is derived from the vertices: the bounds and, if requested, flat normals.
void complete_mesh(Mesh& mesh, bool flat_normals);

}  // namespace simvis
