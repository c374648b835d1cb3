// The commands of the elements that joints of a robot or a world become, whatever the format.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "import/model/model_description.h"

namespace simvis {

/// What is wrong with what a joint follows, such as "mimics itself in a circle".
using WrongLeader = std::function<void(const ModelJoint& joint, const std::string& what)>;

/// A follower of a follower follows the last joint of the chain. One whose leader is not there, does not turn or slide,
/// or follows it in the end is given to `wrong`; if that returns, the joint moves by itself.
void resolve_leaders(const std::vector<ModelJoint*>& joints, const WrongLeader& wrong);

/// Collects joints, whose leaders are resolved, and writes their commands:
///
/// revolute, continuous, prismatic  an element `joint` of the joint's name; without limits where the joint has none
/// the same with a leader           an element `mimic_joint`, whose own limits are not applied
/// floating, ball                   an element `pose`
/// planar                           two prismatic joints, NAME_X and NAME_Y, and a revolute one, NAME_TURN, about the
///                                  axis; X is the frame's x axis projected into the plane (y if the axis is near x)
/// fixed                            no command
///
/// Radians become degrees. A value starts at 0, or at the limit nearest to 0.
class JointCommands {
 public:
  /// `point` is the insertion point in whose frame the axis stands: the element moves everything behind it.
  void add(const ModelJoint& joint, const std::string& point) { joints_.push_back({joint, point}); }

  /// The warning about joints for which 0 is outside of their limits: one for all, with the place and the limits of the
  /// first. Empty: there are none.
  std::optional<std::string> start_warning() const;

  /// The commands in the order of add(), followers behind all others. A follower of a joint that was not added moves by
  /// itself.
  std::vector<std::string> release();

 private:
  struct Placed {
    ModelJoint joint;
    std::string point;
  };
  std::vector<Placed> joints_;
};

}  // namespace simvis
