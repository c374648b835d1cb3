// The box of a mesh in another frame: its middle, its lengths along its own axes, and its orientation.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include <simvis/mesh.h>
#include "engine/base/program_api.h"

namespace simvis {

/// Frames   F = the frame that the box stands in.
struct OrientedBox {
  glm::dvec3 centre_m{0},              ///< F
      size_m{0};                       ///< along the axes of the box
  glm::dquat orientation{1, 0, 0, 0};  ///< F from the box's own frame; w is at least 0
};

/// The box of the mesh's bounds. A mesh that is scaled unevenly and turned has the box of its box, whose x axis is the
/// mesh's. A mesh that is flattened along an axis has the length 0 across the others.
SIMVIS_PROGRAM_API OrientedBox oriented_box(const Mesh& mesh, const glm::dmat4& frame_from_mesh);

}  // namespace simvis
