#include "elements/joint_motion.h"

#include <algorithm>
#include <cmath>

#include <simvis/pose.h>

namespace simvis {
namespace {

void normalize_axis(JointMotion& motion, const AttributeValues& attributes) {
  const glm::dvec3& v = motion.axis;
  const double largest = std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])});
  if (largest == 0) {
    fail_at(attributes.where("axis"), "attribute \"axis\": 0 0 0 is not allowed, expected a vector that is not zero");
  }
  // The division by the largest component keeps the squares from overflow and underflow.
  motion.axis = glm::normalize(v / largest);
}

// Rodrigues' rotation formula. The axis has unit length.
glm::dmat4 turn_about(const glm::dvec3& axis, double angle_deg) {
  const auto [s, c] = sincos_deg(angle_deg);
  glm::dmat4 m{1.0};
  for (int column = 0; column < 3; ++column) {
    glm::dvec3 unit{0};
    unit[column] = 1;
    m[column] = glm::dvec4(c * unit + s * glm::cross(axis, unit) + (1 - c) * axis[column] * axis, 0);
  }
  return m;
}

}  // namespace

glm::dmat4 JointMotion::at(double value) const {
  if (revolute) return turn_about(axis, value);
  glm::dmat4 m{1.0};
  m[3] = {value * axis, 1};
  return m;
}

AttributeRows<JointMotion> JointMotion::rows() {
  return {row(&JointMotion::axis, "axis", "", kAnyNumber,
              "direction of the axis through the origin; its length does not matter"),
          row(&JointMotion::revolute, "kind", {{true, "revolute"}, {false, "prismatic"}},
              "turns about the axis, or slides along it"),
          checked<JointMotion>(normalize_axis)};
}

}  // namespace simvis
