#include "import/urdf/urdf_pose.h"

#include <glm/gtc/quaternion.hpp>

namespace simvis {

glm::dmat4 matrix_of(const urdf::Pose& pose) {
  const urdf::Rotation& r = pose.rotation;
  glm::dmat4 matrix = glm::mat4_cast(glm::dquat(r.w, r.x, r.y, r.z));
  matrix[3] = {pose.position.x, pose.position.y, pose.position.z, 1};
  return matrix;
}

}  // namespace simvis
