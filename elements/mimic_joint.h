// The element `mimic_joint`: a joint that follows another one, as the second finger of a gripper does.
//
//   <element type="mimic_joint" name="FINGER_2" insert_at="FINGER_2_LINK" leader="FINGER_1" multiplier="-1"/>
//
// Its value is multiplier * leader + offset, each in its own unit: a turn in degrees, a slide in metres. Where the two
// are of different kinds, the multiplier is in m/deg or deg/m. The value has no limits but those that follow from the
// leader's.
// Frames   as for `joint`.
// Parameters  none.
#pragma once

#include <simvis/element.h>

namespace simvis {

class MimicJointElement : public Element {
 public:
  /// Throws InputError at the attribute: an axis of zero length, a leader that is no element of type joint.
  explicit MimicJointElement(const ElementContext& context);
  void update(ParameterView) override {}
};

}  // namespace simvis
