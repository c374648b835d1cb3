// The element `joint`: turns everything after its insertion point about an axis, or slides it along an axis.
//
//   <element type="joint" name="TILT" insert_at="HEAD" axis="0 1 0" lower="-30" upper="60" value="10"/>
//
// Frames   the axis passes through the origin of the insertion point's frame; the rotation is right-handed about it.
// Parameters  value (live), from `lower` to `upper`: degrees for the kind revolute, metres for the kind prismatic.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <simvis/element.h>
#include <simvis/node.h>
#include <simvis/state_archive.h>
#include "elements/joint_motion.h"

namespace simvis {

/// What a joint shares with the physics that moves it.
struct JointDriver {
  /// The position at the time of a frame, in deg or m. Empty: nothing moves the joint but its value.
  std::function<double(std::int64_t time_ns)> value;
  /// Its velocity then, in deg/s or m/s; empty before the first frame. Set together with `value`.
  std::function<std::optional<double>()> speed;
  /// The effort of its drive in the last step of physics, in N m or N; NaN where no step is made, as in a simulation
  /// that follows another one. Set together with `value`.
  std::function<double()> effort;
  double current = 0;    ///< the joint's value, in deg or m
  bool was_set = false;  ///< `current` comes from outside, and `value` has not taken it over yet
};

class JointElement : public Element, public Stateful {
 public:
  /// Throws InputError at the attribute if the axis has zero length or `lower` is above `upper`.
  explicit JointElement(const ElementContext& context);
  void update(ParameterView values) override;
  void adapt_parameters(std::vector<AttributeSpec>& live_rows) const override;

  /// Calls `follower` with the present value now, and with every new value later. Returns its number for unfollow().
  std::size_t follow(std::function<void(double value)> follower);
  void unfollow(std::size_t number) { followers_.erase(number); }

  const JointMotion& motion() const { return motion_; }
  /// The insertion point at which it stands, which moves with it.
  const std::string& point() const { return point_; }
  /// Never null. Physics sets JointDriver::value, and empties it at its end.
  const std::shared_ptr<JointDriver>& driver() const { return driver_; }
  bool moves_itself() const override { return driver_->value != nullptr; }
  /// The velocity in deg/s or m/s at the time of the frame, of a joint that physics moves; empty for others.
  std::optional<double> speed() const { return driver_->speed && !driver_->was_set ? driver_->speed() : std::nullopt; }
  /// The effort of its drive, see JointDriver; empty: no physics moves the joint.
  std::optional<double> effort() const { return driver_->effort ? std::optional(driver_->effort()) : std::nullopt; }
  bool slides() const { return !motion_.revolute; }
  bool has_limits() const;
  /// Takes the value from the driver. One beyond a limit shows the limit.
  void advance(std::int64_t time_ns, std::span<double> values) override;
  void archive(StateArchive& state) override { state(shown_, driver_->current, driver_->was_set); }

  /// AttributeSpec::rounding of limits, in deg or m.
  static double limit_rounding(bool revolute);

 private:
  std::shared_ptr<Transform> transform_;
  std::string point_;
  JointMotion motion_;
  double lower_, upper_;         // deg or m
  double value_ = 0;             // deg or m
  std::optional<double> shown_;  // the last value of the driver
  std::shared_ptr<JointDriver> driver_ = std::make_shared<JointDriver>();
  std::map<std::size_t, std::function<void(double)>> followers_;
  std::size_t next_follower_ = 0;
};

}  // namespace simvis
