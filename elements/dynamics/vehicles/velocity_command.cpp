// The element `velocity_command`: a vehicle moves as messages of geometry_msgs/Twist, or clients, command.
//
//   <element type="velocity_command" name="COMMAND" insert_at="MARVIN" vehicle="DRIVE" topic="/cmd_vel"/>
//
// Frames      the vehicle's part: forward along x, turning about z, to the left.
// Parameters  command: each new value is a command; forward (m/s) and turn (deg/s) hold from then on, for `timeout`.
//             `left` (m/s) too, which only vehicles with rollers can follow. After that the wheels stop. Without a
//             command the vehicle's own parameters hold.
#include <glm/trigonometric.hpp>
#include <memory>
#include <string>

#include <simvis/element.h>
#include <simvis/node.h>
#include "elements/command_source.h"
#include "elements/dynamics/command_timer.h"
#include "elements/dynamics/vehicles/vehicle.h"

namespace simvis {
namespace {

class VelocityCommandElement : public Element, public Stateful, public CommandSource {
 public:
  /// Throws InputError: the element is no vehicle, or the topic no topic of ROS.
  explicit VelocityCommandElement(const ElementContext& context);
  void update(ParameterView values) override;
  void archive(StateArchive& state) override { state(timer_); }

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

constexpr double kMaxForward_m_s = 1e3, kMaxTurn_deg_s = 1e5;

constexpr AttributeSpec kVelocityCommandRows[] = {
    {.name = "vehicle", .kind = AttributeKind::element, .text = "required: the element of type vehicle that moves"},
    {.name = "topic",
     .kind = AttributeKind::text,
     .text = "topic of geometry_msgs/Twist and TwistStamped messages; default: /NAME/cmd_vel"},
    kCommandTimeoutRow,
    kCommandRow,
    {.name = "forward",
     .default_value = "0",
     .unit = "m/s",
     .text = "speed along x of the vehicle's part",
     .min = -kMaxForward_m_s,
     .max = kMaxForward_m_s,
     .live = true},
    {.name = "turn",
     .default_value = "0",
     .unit = "deg/s",
     .text = "rate of turning about z; positive is to the left",
     .min = -kMaxTurn_deg_s,
     .max = kMaxTurn_deg_s,
     .live = true},
    {.name = "left",
     .default_value = "0",
     .unit = "m/s",
     .text = "speed along y of the vehicle's part; only mecanum and omni drives move so",
     .min = -kMaxForward_m_s,
     .max = kMaxForward_m_s,
     .live = true},
};

const ElementRegistration kVelocityCommandRegistration({
    .name = "velocity_command",
    .summary = "A vehicle moves as ROS messages or clients command, and stops when they end.",
    .notes = "A command sets the vehicle's wheels: of a differential drive and tracks left and right, of an ackermann "
             "drive speed and steer, of mecanum and omni drives the speed of each wheel. Wheels that would be faster "
             "than they can turn are slowed down together. Of a Twist, linear.x, linear.y and angular.z count. In "
             "shared memory, write forward, turn and left, then command.",
    .attributes = kVelocityCommandRows,
    .create = create_element<VelocityCommandElement>,
});

}  // namespace

VelocityCommandElement::VelocityCommandElement(const ElementContext& context)
    : name_(context.command.require("name").value),
      topic_(command_topic(context, "topic", "cmd_vel", CommandContent::velocity)),
      timer_(context.attributes.number("timeout")) {
  const CommandAttribute& vehicle = context.command.require("vehicle");
  vehicle_ = dynamic_cast<VehicleElement*>(context.find_element(vehicle.value));
  if (vehicle_ == nullptr) {
    fail_at(vehicle.where, "attribute \"vehicle\": " + in_quotes(vehicle.value) +
                               " is not allowed, expected the name of an element of type vehicle");
  }
  const auto mark = std::make_shared<Group>();
  mark->name = name_;
  context.scene.insert(context.command, mark);
}

void VelocityCommandElement::update(ParameterView values) {
  timer_.set(values[0]);
  wanted_ = {.forward_m_s = values[1], .turn_rad_s = glm::radians(values[2]), .left_m_s = values[3]};
}

AcceptedCommand VelocityCommandElement::accept(const VelocityCommand& command) {
  return {.settings = {{name_, "command", timer_.next()},
                       {name_, "forward", command.forward_m_s},
                       {name_, "turn", glm::degrees(command.turn_rad_s)},
                       {name_, "left", command.left_m_s}}};
}

std::vector<ParameterSetting> VelocityCommandElement::before_frame(std::int64_t begin_ns, std::int64_t /*end_ns*/) {
  switch (timer_.at(begin_ns)) {
    case CommandTimer::Event::begins:
      return vehicle_->settings_of(wanted_);
    case CommandTimer::Event::ends:
      return vehicle_->settings_of({});
    case CommandTimer::Event::none:
      break;
  }
  return {};
}

}  // namespace simvis
