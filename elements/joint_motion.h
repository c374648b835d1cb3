// The motion of a joint, shared by all joint elements.
#pragma once

#include <glm/glm.hpp>

#include "scenegraph/language/attribute_rows.h"

namespace simvis {

/// A right-handed rotation about an axis through the origin, or a translation along it.
struct JointMotion {
  glm::dvec3 axis{0, 0, 1};  ///< unit length
  bool revolute = true;

  /// Returns the transform at `value`, in degrees (revolute) or metres (prismatic).
  glm::dmat4 at(double value) const;

  /// For the tables of joint elements. Reading throws InputError if the axis has zero length.
  static AttributeRows<JointMotion> rows();
};

}  // namespace simvis
