// Poses as people write them, and the matrices that they stand for.
#pragma once

#include <glm/glm.hpp>

namespace simvis {

/// x forward, y left, z up (REP 103); R = Rz(yaw) Ry(pitch) Rx(roll).
struct Pose {
  glm::dvec3 position_m{0};
  double roll_rad = 0, pitch_rad = 0, yaw_rad = 0;
};

/// parent_from_child. Angles of any size are reduced exactly before sine and cosine are taken.
glm::dmat4 to_matrix(const Pose& pose);

/// The inverse of a matrix that only turns and moves.
glm::dmat4 rigid_inverse(const glm::dmat4& m);

/// sensor_from_view of a camera that looks along +x of its sensor frame: the view frame is x right, y down, z forward.
const glm::dmat4& sensor_from_view();

}  // namespace simvis
