// The element `force`: a force and a torque on a body, by parameters or messages of geometry_msgs/Wrench.
//
//   <element type="force" name="PUSH" insert_at="BOX" point="0.1 0 0" frame="body" force_x="5"/>
//
// Frames      point is in the frame of the insertion point; force and torque in that or in the world, as `frame` says.
// Parameters  force_x force_y force_z (N), torque_x torque_y torque_z (N m), which hold until they change; command:
//             each new value is a command, whose force and torque become 0 after `timeout`.
#include <string>
#include <utility>

#include "elements/command_source.h"
#include "elements/dynamics/command_timer.h"
#include "elements/dynamics/forces/wrench_element.h"
#include "scenegraph/language/attribute_rows.h"

namespace simvis {
namespace {

struct ForceDesc {
  glm::dvec3 point_m{0};
  bool in_world = true;
  double force_x_n = 0, force_y_n = 0, force_z_n = 0, torque_x_nm = 0, torque_y_nm = 0, torque_z_nm = 0;

  static AttributeRows<ForceDesc> rows();
};

class ForceElement : public WrenchElement, public Stateful, public CommandSource {
 public:
  /// Throws InputError: what WrenchElement throws, or the topic is no topic of ROS.
  explicit ForceElement(const ElementContext& context);
  void update(ParameterView values) override;
  void archive(StateArchive& state) override { state(timer_); }
  Wrench wrench(const PushedBody& body, const PhysicsStep& step) override;

  std::vector<CommandTopic> command_topics() const override { return {topic_}; }
  std::int64_t timeout_ns() const override { return timer_.timeout_ns(); }
  using CommandSource::accept;
  AcceptedCommand accept(const WrenchCommand& command) override;
  std::vector<ParameterSetting> before_frame(std::int64_t begin_ns, std::int64_t end_ns) override;

 private:
  std::vector<ParameterSetting> settings_of(const WrenchCommand& command) const;

  ForceDesc desc_;
  CommandTopic topic_;
  CommandTimer timer_;
};

constexpr AttributeSpec kForceCommandRows[] = {
    {.name = "topic",
     .kind = AttributeKind::text,
     .text = "topic of geometry_msgs/Wrench and WrenchStamped messages; default: /NAME/wrench"},
    kCommandTimeoutRow,
    kCommandRow,
};

const ElementRegistration kForceRegistration({
    .name = "force",
    .summary = "Exerts a force and a torque on the body at its insertion point, in each step of physics.",
    .notes = "Needs a dynamic body, or a link of a robot, before it at the insertion point. The force acts at point, "
             "and the torque is added to that of the force. Values that are set hold until they change. A command, by "
             "a message or by a new value of command, ends after timeout: force and torque are 0 then. In shared "
             "memory, write the values, then command.",
    .attributes = AttributeRows<ForceDesc>{AttributeTable(kForceCommandRows), ForceDesc::rows()}.table(),
    .create = create_element<ForceElement>,
});

}  // namespace

AttributeRows<ForceDesc> ForceDesc::rows() {
  using Desc = ForceDesc;
  return {row(&Desc::point_m, "point", "m", kPushedPlace, "where the force acts, in the frame of the insertion point"),
          row(&Desc::in_world, "frame", {{true, "world"}, {false, "body"}},
              "the axes of force and torque: those of the world, or of the insertion point, which turn with the body"),
          row(&Desc::force_x_n, "force_x", "N", kPushingForce, "force along x of frame").live(),
          row(&Desc::force_y_n, "force_y", "N", kPushingForce, "along y").live(),
          row(&Desc::force_z_n, "force_z", "N", kPushingForce, "along z").live(),
          row(&Desc::torque_x_nm, "torque_x", "N m", kPushingForce, "torque about x of frame").live(),
          row(&Desc::torque_y_nm, "torque_y", "N m", kPushingForce, "about y").live(),
          row(&Desc::torque_z_nm, "torque_z", "N m", kPushingForce, "about z").live()};
}

ForceElement::ForceElement(const ElementContext& context)
    : WrenchElement(context),
      desc_(rows_of<ForceDesc>().read(context.attributes)),
      topic_(command_topic(context, "topic", "wrench", CommandContent::wrench)),
      timer_(context.attributes.number("timeout")) {}

void ForceElement::update(ParameterView values) {
  timer_.set(values[0]);
  rows_of<ForceDesc>().set(desc_, values.subspan(1));
}

Wrench ForceElement::wrench(const PushedBody& body, const PhysicsStep& /*step*/) {
  glm::dvec3 force(desc_.force_x_n, desc_.force_y_n, desc_.force_z_n),
      torque(desc_.torque_x_nm, desc_.torque_y_nm, desc_.torque_z_nm);
  if (!desc_.in_world) {
    force = body.direction(force);
    torque = body.direction(torque);
  }
  Wrench wrench = wrench_at(body.arm_m(desc_.point_m), force);
  wrench.torque_nm += torque;
  return wrench;
}

std::vector<ParameterSetting> ForceElement::settings_of(const WrenchCommand& command) const {
  const glm::dvec3 &f = command.force_n, &t = command.torque_nm;
  return {{name(), "force_x", f.x},  {name(), "force_y", f.y},  {name(), "force_z", f.z},
          {name(), "torque_x", t.x}, {name(), "torque_y", t.y}, {name(), "torque_z", t.z}};
}

AcceptedCommand ForceElement::accept(const WrenchCommand& command) {
  std::vector<ParameterSetting> settings = settings_of(command);
  settings.insert(settings.begin(), {name(), "command", timer_.next()});
  return {.settings = std::move(settings)};
}

std::vector<ParameterSetting> ForceElement::before_frame(std::int64_t begin_ns, std::int64_t /*end_ns*/) {
  if (timer_.at(begin_ns) != CommandTimer::Event::ends) return {};
  return settings_of({});
}

}  // namespace simvis
