// Poses as people write them, and the matrices that they stand for.
#pragma once

#include <glm/glm.hpp>

namespace simvis {

/// Positions farther out than this are refused, so that no chain of them overflows.
inline constexpr double kMaxCoordinate_m = 1e15;

/// x forward, y left, z up (REP 103); R = Rz(yaw) Ry(pitch) Rx(roll).
struct Pose {
  glm::dvec3 position_m{0};
  double roll_rad = 0, pitch_rad = 0, yaw_rad = 0;
};

/// parent_from_child.
glm::dmat4 to_matrix(const Pose& pose);

/// The same from angles in degrees, as people write them; so a quarter turn is one, to the last bit. See sincos_deg().
glm::dmat4 matrix_from_degrees(const glm::dvec3& position_m, double roll_deg, double pitch_deg, double yaw_deg);

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
