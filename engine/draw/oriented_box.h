// A box in another frame: its middle, its lengths along its own axes, and its orientation.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include "engine/base/program_api.h"

namespace simvis {

/// Frames   F = the frame that the box stands in.
struct OrientedBox {
  glm::dvec3 centre_m{0},              ///< F
      size_m{0};                       ///< along the axes of the box
  glm::dquat orientation{1, 0, 0, 0};  ///< F from the box's own frame; w is at least 0
};

/// The box between two corners of another frame, along whose axes it stands. A frame that is scaled unevenly and turned
/// gives the box of this box, whose x axis is the frame's. A frame that is flattened along an axis gives the length 0
/// across the others.
SIMVIS_PROGRAM_API OrientedBox oriented_box(const glm::dvec3& low, const glm::dvec3& high,
                                            const glm::dmat4& frame_from_box);

}  // namespace simvis
