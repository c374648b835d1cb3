#include "elements/pose_rows.h"

#include <glm/trigonometric.hpp>

namespace simvis {

void write_pose(const glm::dmat4& rigid, std::span<double> values) {
  const Pose pose = to_pose(rigid);
  for (int i = 0; i < 3; ++i) values[static_cast<std::size_t>(i)] = pose.position_m[i];
  values[3] = glm::degrees(pose.roll_rad);
  values[4] = glm::degrees(pose.pitch_rad);
  values[5] = glm::degrees(pose.yaw_rad);
}

}  // namespace simvis
