#include <simvis/pose.h>

#include <cmath>
#include <glm/gtc/constants.hpp>

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
  // Both remainders are exact in floating point. `rest` lies within +-45 degrees.
  const double turn_part = std::remainder(angle_deg, 360.0);
  const double rest = std::remainder(turn_part, 90.0);
  const int quarter = static_cast<int>(std::lround((turn_part - rest) / 90.0)) & 3;
  const double radians = rest * (glm::pi<double>() / 180.0);
  // The addition of 0 turns -0 into 0, so that equal poses give equal bytes.
  const double s = std::sin(radians) + 0.0, c = std::cos(radians);
  switch (quarter) {
    case 0:
      return {s, c};
    case 1:
      return {c, 0.0 - s};
    case 2:
      return {0.0 - s, -c};
    default:
      return {-c, s};
  }
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

}  // namespace simvis
