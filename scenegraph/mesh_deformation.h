// Meshes that morph targets and joints deform: what they are, and what they become.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include <simvis/mesh.h>

namespace simvis {

/// By how much a full weight changes each vertex. Each as long as the mesh's positions, or empty where it does nothing.
struct MorphTarget {
  std::vector<glm::vec3> position_changes, normal_changes;
};

struct JointInfluence {
  std::uint32_t joint = 0;
  float weight = 0;
};

/// A mesh before it is deformed.
struct DeformableMesh {
  Mesh base;                  ///< its bounds are not set
  bool flat_normals = false;  ///< triangles without normals of their own: each gets its plane's, as it then lies
  std::vector<MorphTarget> targets;
  std::size_t influences_per_vertex = 0;   ///< 0: no joints move it
  std::vector<JointInfluence> influences;  ///< vertex by vertex; each vertex's weights have a sum above 0
};

/// The mesh with every target added by its weight, and then moved by its joints (linear blend skinning), in double and
/// rounded once; with bounds. Normals stay perpendicular to their surfaces.
/// `weights` has one value per target, or none, which stands for zeros; `joint_matrices` (frame of the mesh to that of
/// its result, affine) has one per joint and is not looked at without influences.
/// Nothing when a vertex comes to lie where float32 is not finite.
std::optional<Mesh> deform(const DeformableMesh& source, std::span<const double> weights,
                           std::span<const glm::dmat4> joint_matrices);

/// Sets what is derived from the vertices: the bounds and, where wanted, flat normals.
void complete_mesh(Mesh& mesh, bool flat_normals);

}  // namespace simvis
