// The element `joint`: turns everything after its insertion point about an axis, or slides it along an axis.
//
//   <element type="joint" name="TILT" insert_at="HEAD" axis="0 1 0" lower="-30" upper="60" value="10"/>
//
// Frames   the axis passes through the origin of the insertion point's frame; the rotation is right-handed about it.
// Parameters  value (live), from `lower` to `upper`: degrees for the kind revolute, metres for the kind prismatic.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <vector>

#include <simvis/element.h>
#include <simvis/node.h>
#include "elements/joint_motion.h"

namespace simvis {

class JointElement : public Element {
 public:
  /// Throws InputError at the attribute if the axis has zero length or `lower` is above `upper`.
  explicit JointElement(const ElementContext& context);
  void update(ParameterView values) override;
  void adapt_parameters(std::vector<AttributeSpec>& live_rows) const override;

  /// Calls `follower` with the present value now, and with every new value later. Returns its number for unfollow().
  std::size_t follow(std::function<void(double value)> follower);
  void unfollow(std::size_t number) { followers_.erase(number); }

 private:
  std::shared_ptr<Transform> transform_;
  JointMotion motion_;
  double lower_, upper_;  // deg or m
  double value_ = 0;      // deg or m
  std::map<std::size_t, std::function<void(double)>> followers_;
  std::size_t next_follower_ = 0;
};

}  // namespace simvis
