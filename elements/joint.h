// The element `joint`: turns what follows its insertion point about an axis, or slides it along one.
//
//   <element type="joint" name="TILT" insert_at="HEAD" axis="0 1 0" lower="-30" upper="60" value="10"/>
//
// Frames   the axis goes through the origin of the insertion point's frame; the turn is right-handed about it.
// Parameters  value (live): deg for kind revolute, m for kind prismatic, within lower and upper.
#pragma once

#include <functional>
#include <vector>

#include <simvis/element.h>
#include <simvis/node.h>
#include "elements/joint_motion.h"

namespace simvis {

class JointElement : public Element {
 public:
  /// Throws InputError at the attribute: an axis of zero length, `lower` above `upper`.
  explicit JointElement(const ElementContext& context);
  void update(ParameterView values) override;
  void adapt_parameters(std::vector<AttributeSpec>& live_rows) const override;

  /// `follower` is called with every value from now on, beginning with the present one.
  void follow(std::function<void(double value)> follower);
  /// Takes the last one back.
  void remove_last_follower() { followers_.pop_back(); }

 private:
  std::shared_ptr<Transform> transform_;
  JointMotion motion_;
  double lower_, upper_;  // deg or m
  double value_ = 0;      // deg or m
  std::vector<std::function<void(double)>> followers_;
};

}  // namespace simvis
