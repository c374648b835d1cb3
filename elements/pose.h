// The element `pose`: moves and turns everything after its insertion point.
//
//   <element type="pose" name="R_POSE" insert_at="ROBOT" x="1" y="2" z="3" yaw="-90"/>
//
// A pose that is inserted at a part's name stands before the part. It moves the part and everything that is inserted
// there later.
// Frames   x forward, y left, z up (REP 103); R = Rz(yaw) Ry(pitch) Rx(roll).
// Parameters  x y z (m), roll pitch yaw (deg), all live. Angles of any size are reduced exactly.
#pragma once

#include <simvis/element.h>
#include <simvis/node.h>

namespace simvis {

class PoseElement : public Element {
 public:
  explicit PoseElement(const ElementContext& context);
  void update(ParameterView values) override;

 private:
  std::shared_ptr<Transform> transform_;
};

}  // namespace simvis
