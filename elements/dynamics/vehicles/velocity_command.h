// The element `velocity_command`: a vehicle moves as messages of geometry_msgs/Twist, or clients, command.
//
//   <element type="velocity_command" name="COMMAND" insert_at="MARVIN" vehicle="DRIVE" topic="/cmd_vel"/>
//
// Frames      the vehicle's part: forward along x, turning about z, to the left.
// Parameters  command: each new value is a command; forward (m/s) and turn (deg/s) hold from then on, for `timeout`.
//             `left` (m/s) too, which only vehicles with rollers can follow. After that the wheels stop. Without a
//             command the vehicle's own parameters hold.
#pragma once

#include <string>

#include <simvis/element.h>
#include "elements/command_source.h"
#include "elements/dynamics/command_timer.h"

namespace simvis {

class VehicleElement;

class VelocityCommandElement : public Element, public CommandSource {
 public:
  /// Throws InputError: the element is no vehicle, or the topic no topic of ROS.
  explicit VelocityCommandElement(const ElementContext& context);
  void update(ParameterView values) override;

  std::vector<CommandTopic> command_topics() const override { return {topic_}; }
  std::int64_t timeout_ns() const override { return timer_.timeout_ns(); }
  using CommandSource::accept;
  AcceptedCommand accept(const VelocityCommand& command) override;
  std::vector<ParameterSetting> before_frame(std::int64_t begin_ns, std::int64_t end_ns) override;

 private:
  std::string name_;
  CommandTopic topic_;
  const VehicleElement* vehicle_;  // the scene keeps it as long as this element
  CommandTimer timer_;
  VelocityCommand wanted_;
};

}  // namespace simvis
