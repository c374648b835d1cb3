// The element `mimic_joint`: a joint that follows another joint, as the second finger of a gripper does.
//
//   <element type="mimic_joint" name="FINGER_2" insert_at="FINGER_2_LINK" leader="FINGER_1" multiplier="-1"/>
//
// Its value is multiplier * leader + offset, with each value in its own unit: degrees for a rotation, metres for a
// slide. If the two joints are of different kinds, the multiplier is in m/deg or deg/m. The limits of the leader are
// the only limits of the value.
// Frames   the same as for `joint`.
// Parameters  none.
#pragma once

#include <string>

#include <simvis/element.h>

namespace simvis {

class MimicJointElement : public Element {
 public:
  /// Throws InputError at the attribute if the axis has zero length or the leader is not an element of the type joint.
  explicit MimicJointElement(const ElementContext& context);
  void update(ParameterView) override {}

  /// The value is multiplier * value of `leader` + offset. Each value is in deg if its joint turns, in m if it slides.
  struct Law {
    std::string leader;
    double multiplier = 1, offset = 0;
    bool slides = false;  ///< whether this joint slides
  };
  const Law& law() const { return law_; }

 private:
  Law law_;
};

}  // namespace simvis
