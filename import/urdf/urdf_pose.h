// Converts liburdfdom's poses to matrices.
#pragma once

#include <urdf_model/pose.h>

#include <glm/glm.hpp>

namespace simvis {

/// Returns parent_from_child. The pose holds a unit quaternion, made from roll, pitch and yaw in radians.
glm::dmat4 matrix_of(const urdf::Pose& pose);

}  // namespace simvis
