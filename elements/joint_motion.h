// The motion of a joint, shared by all joint elements.
#pragma once

#include <glm/glm.hpp>

#include <simvis/attributes.h>

namespace simvis {

/// Rows for the attribute tables of joint elements.
inline constexpr AttributeSpec kAxisAttribute{
    .name = "axis",
    .kind = AttributeKind::vector,
    .default_value = "0 0 1",
    .text = "direction of the axis through the origin; its length does not matter"};
inline constexpr AttributeSpec kJointKindAttribute{.name = "kind",
                                                   .kind = AttributeKind::choice,
                                                   .default_value = "revolute",
                                                   .text = "turns about the axis, or slides along it",
                                                   .choices = "revolute prismatic"};

/// A right-handed rotation about an axis through the origin, or a translation along it.
struct JointMotion {
  glm::dvec3 axis{0, 0, 1};  ///< unit length
  bool revolute = true;

  /// Returns the transform at `value`, in degrees (revolute) or metres (prismatic).
  glm::dmat4 at(double value) const;
};

/// Reads the motion from the rows above. Throws InputError if the axis has zero length.
JointMotion read_joint_motion(const AttributeValues& attributes);

}  // namespace simvis
