// The element `pose`: moves and turns everything after its insertion point.
//
//   <element type="pose" name="R_POSE" insert_at="ROBOT" x="1" y="2" z="3" yaw="-90"/>
//
// A pose that is inserted at a part's name stands before the part. It moves the part and everything that is inserted
// there later. With moves="all" it stands in front of all of a part or link, and moves what was inserted there before,
// too. Frames   x forward, y left, z up (REP 103); R = Rz(yaw) Ry(pitch) Rx(roll). Parameters  x y z (m), roll pitch
// yaw (deg), all live. Angles of any size are reduced exactly.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include <simvis/element.h>
#include <simvis/node.h>

namespace simvis {

/// What a pose shares with the physics that turns it: that of a ball joint.
struct PoseDriver {
  /// The rigid matrix at the time of a frame. Empty: nothing moves the pose but its values.
  std::function<glm::dmat4(std::int64_t time_ns)> value;
  glm::dmat4 current{1.0};
  bool was_set = false;  ///< `current` comes from outside, and `value` has not taken it over yet
};

class PoseElement : public Element {
 public:
  explicit PoseElement(const ElementContext& context);
  void update(ParameterView values) override;

  /// Never null. Physics sets PoseDriver::value, and empties it at its end.
  const std::shared_ptr<PoseDriver>& driver() const { return driver_; }
  bool moves_itself() const override { return driver_->value != nullptr; }
  /// Takes the values from the driver.
  void advance(std::int64_t time_ns, std::span<double> values) override;

 private:
  std::shared_ptr<Transform> transform_;
  std::vector<double> shown_;  // the last values of the driver
  std::shared_ptr<PoseDriver> driver_ = std::make_shared<PoseDriver>();
};

}  // namespace simvis
