#include <simvis/pose.h>

#include <cmath>

#include "engine/base/sine_of_degrees.h"

namespace simvis {
namespace {

// Rz(yaw) Ry(pitch) Rx(roll), then the position.
glm::dmat4 matrix(const glm::dvec3& position_m, SinCos roll, SinCos pitch, SinCos yaw) {
  const auto [sr, cr] = roll;
  const auto [sp, cp] = pitch;
  const auto [sy, cy] = yaw;
  glm::dmat4 m{1.0};
  m[0] = {cy * cp, sy * cp, -sp, 0};
  m[1] = {cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, cp * sr, 0};
  m[2] = {cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr, 0};
  m[3] = {position_m, 1};
  return m;
}

}  // namespace

SinCos sincos_deg(double angle_deg) {
  const SineCosine value = sine_of_degrees(angle_deg);
  return {value.sin, value.cos};
}

glm::dmat4 to_matrix(const Pose& pose) {
  const auto sincos = [](double angle_rad) { return SinCos{std::sin(angle_rad), std::cos(angle_rad)}; };
  return matrix(pose.position_m, sincos(pose.roll_rad), sincos(pose.pitch_rad), sincos(pose.yaw_rad));
}

glm::dmat4 matrix_from_degrees(const glm::dvec3& position_m, double roll_deg, double pitch_deg, double yaw_deg) {
  return matrix(position_m, sincos_deg(roll_deg), sincos_deg(pitch_deg), sincos_deg(yaw_deg));
}

glm::dmat4 rigid_inverse(const glm::dmat4& m) {
  const glm::dmat3 turned_back = glm::transpose(glm::dmat3(m));
  glm::dmat4 inverse(turned_back);
  inverse[3] = {-(turned_back * glm::dvec3(m[3])), 1};
  return inverse;
}

const glm::dmat4& sensor_from_view() {
  // The columns are the view's right, down and forward directions in the sensor frame.
  static const glm::dmat4 matrix{{0, -1, 0, 0}, {0, 0, -1, 0}, {1, 0, 0, 0}, {0, 0, 0, 1}};
  return matrix;
}

Pose to_pose(const glm::dmat4& rigid) {
  const auto r = [&](int row, int column) { return rigid[column][row]; };
  Pose pose{.position_m = glm::dvec3(rigid[3])};
  pose.yaw_rad = std::atan2(r(1, 0), r(0, 0));
  // The other angles are those of Rz(-yaw) R, so that errors of yaw near the poles cancel.
  const double c = std::cos(pose.yaw_rad), s = std::sin(pose.yaw_rad);
  pose.pitch_rad = std::atan2(-r(2, 0), c * r(0, 0) + s * r(1, 0));
  pose.roll_rad = std::atan2(s * r(0, 2) - c * r(1, 2), c * r(1, 1) - s * r(0, 1));
  return pose;
}

bool is_rigid(const glm::dmat4& m, double tolerance) {
  const glm::dmat3 rotation(m);
  const glm::dmat3 product = rotation * glm::transpose(rotation);
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) {
      if (!(std::abs(product[column][row] - (column == row ? 1 : 0)) <= tolerance)) return false;
    }
  }
  for (int column = 0; column < 4; ++column) {
    if (!(std::abs(m[column][3] - (column == 3 ? 1 : 0)) <= tolerance)) return false;
    if (!std::isfinite(m[3][column])) return false;
  }
  return glm::determinant(rotation) > 0;
}

}  // namespace simvis
