// The element `joint_command`: the joints of a robot move as messages or clients command.
//
//   <element type="joint_command" name="COMMAND" insert_at="ARM" robot="ARM_BODY"
//   trajectory_topic="/arm/joint_trajectory"/>
//
// Parameters  command: each new value says that targets of the element `robot` were commanded. Targets that are speeds
//             or efforts, and the efforts of servos, become 0 after `timeout`; positions hold.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <simvis/element.h>
#include "elements/command_source.h"
#include "elements/dynamics/command_timer.h"
#include "elements/dynamics/robot.h"

namespace simvis {

class JointCommandElement : public Element, public CommandSource {
 public:
  /// Throws InputError: the element is no robot, or a topic no topic of ROS.
  explicit JointCommandElement(const ElementContext& context);
  void update(ParameterView values) override { timer_.set(values[0]); }

  std::vector<CommandTopic> command_topics() const override { return {state_topic_, values_topic_, trajectory_topic_}; }
  std::int64_t timeout_ns() const override { return timer_.timeout_ns(); }
  bool takes_any(std::span<const std::string> joints) const override;
  using CommandSource::accept;
  AcceptedCommand accept(const JointCommand& command) override;
  AcceptedCommand accept(const JointValues& values) override;
  AcceptedCommand accept(const JointPath& path) override;
  std::vector<ParameterSetting> before_frame(std::int64_t begin_ns, std::int64_t end_ns) override;
  void give_up() override { replace_path(std::nullopt, {}); }

 private:
  std::vector<const RobotElement::DrivenJoint*> find_joints(const std::vector<std::string>& names) const;
  void read_listed(const ElementContext& context);
  void add_target(const RobotElement::DrivenJoint& joint, double value, std::vector<ParameterSetting>& settings) const;
  ParameterSetting target(const RobotElement::DrivenJoint& joint, double value) const;
  static void check_limits(const RobotElement::DrivenJoint& joint, double value);
  static void check_path(const JointPath& path, const std::vector<const RobotElement::DrivenJoint*>& joints);
  void replace_path(std::optional<JointPath> path, std::span<const std::string> commanded);
  void begin_path();
  void follow_path(std::int64_t time_ns, std::vector<ParameterSetting>& settings);

  std::string name_, robot_name_;
  CommandTopic state_topic_, values_topic_, trajectory_topic_;
  const RobotElement* robot_;  // the scene keeps it as long as this element
  std::vector<RobotElement::DrivenJoint> joints_;
  std::vector<std::string> listed_;  // joints whose values come without names
  CommandTimer timer_;
  std::optional<JointPath> path_;      // under way
  bool path_begins_ = false;           // its first point is not there yet
  std::vector<std::string> stopping_;  // joints of a replaced path, whose speeds and efforts become 0
};

}  // namespace simvis
