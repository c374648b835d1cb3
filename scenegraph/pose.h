// Poses as people write them, and the matrices that they stand for.
#pragma once

#include <glm/glm.hpp>

namespace simvis {

/// Positions farther out than this are refused, so that no chain of them overflows.
inline constexpr double kMaxCoordinate_m = 1e15;

/// x forward, y left, z up (REP 103); R = Rz(yaw) Ry(pitch) Rx(roll).
/// The angles stay in degrees, as they were written: so a quarter turn is one, to the last bit.
struct Pose {
  glm::dvec3 position_m{0};
  double roll_deg = 0, pitch_deg = 0, yaw_deg = 0;
};

/// parent_from_child. See sincos_deg() for the angles.
glm::dmat4 to_matrix(const Pose& pose);

struct SinCos {
  double sin, cos;
};

/// Sine and cosine of a finite angle in degrees. Angles of any size are reduced exactly; multiples of 90 degrees give
/// exactly 0, 1 or -1.
SinCos sincos_deg(double angle_deg);

/// The inverse of a matrix that only turns and moves.
glm::dmat4 rigid_inverse(const glm::dmat4& m);

/// sensor_from_view of a camera that looks along +x of its sensor frame: the view frame is x right, y down, z forward.
const glm::dmat4& sensor_from_view();

}  // namespace simvis
