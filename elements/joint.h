// The element `joint`: turns what follows its insertion point about an axis, or slides it along one.
//
//   <element type="joint" name="TILT" insert_at="HEAD" axis="0 1 0" lower="-30" upper="60" value="10"/>
//
// Frames   the axis goes through the origin of the insertion point's frame; the turn is right-handed about it.
// Parameters  value (live): deg for kind revolute, m for kind prismatic, within lower and upper.
#pragma once

#include "elements/element.h"
#include "scenegraph/node.h"

namespace simvis {

class JointElement : public Element {
 public:
  /// Throws InputError at the attribute: an axis of zero length, `lower` above `upper`.
  explicit JointElement(const ElementContext& context);
  void update(ParameterView values) override;
  void adapt_parameters(std::vector<AttributeSpec>& live_rows) const override;

 private:
  std::shared_ptr<Transform> transform_;
  glm::dvec3 axis_{0, 0, 1};  // unit length
  bool revolute_ = true;
  double lower_, upper_;  // deg or m
};

}  // namespace simvis
