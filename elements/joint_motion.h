// What a joint does to what follows it, for all elements that are joints.
#pragma once

#include <glm/glm.hpp>

#include <simvis/attributes.h>

namespace simvis {

/// Rows of the tables of such elements.
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

/// A turn about an axis through the origin, right-handed, or a slide along it.
struct JointMotion {
  glm::dvec3 axis{0, 0, 1};  ///< unit length
  bool revolute = true;

  /// `value` in degrees (revolute) or metres (prismatic).
  glm::dmat4 at(double value) const;
};

/// From the rows above. Throws InputError at an axis of zero length.
JointMotion read_joint_motion(const AttributeValues& attributes);

}  // namespace simvis
