// A rigid transform as position and quaternion, as files and messages give it.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace simvis {

/// A position and a unit quaternion with w >= 0.
struct Pose3 {
  glm::dvec3 position_m{0};
  glm::dquat orientation{1, 0, 0, 0};
};

/// `matrix` is rigid.
inline Pose3 pose_of(const glm::dmat4& matrix) {
  const glm::dquat q = glm::normalize(glm::quat_cast(glm::dmat3(matrix)));
  return {glm::dvec3(matrix[3]), q.w < 0 ? -q : q};
}

}  // namespace simvis
