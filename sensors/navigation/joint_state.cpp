#include "sensors/navigation/joint_state.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

namespace simvis {

namespace {

// Of one joint.
std::vector<TableColumn> joint_columns(const std::string& joint, bool slides) {
  constexpr double kGone = std::numeric_limits<double>::quiet_NaN();
  const std::string unit = slides ? "m" : "rad", motion = slides ? " that slides" : " that turns";
  return {{.name = joint + ".position_" + unit,
           .format = "%.12g",
           .unit = unit,
           .meaning = "position of each joint" + motion,
           .nothing = kGone},
          {.name = joint + ".velocity_" + unit + "_s",
           .format = "%.12g",
           .unit = unit + "/s",
           .meaning = "velocity of each joint" + motion,
           .nothing = kGone}};
}

std::vector<OutputSpec> joint_state_outputs(const SensorContext& context) {
  std::vector<TableColumn> columns = joint_columns("*", false);
  for (TableColumn& column : joint_columns("*", true)) columns.push_back(std::move(column));
  return reading_outputs(context, columns);
}

const SensorRegistration kJointStateRegistration(
    {.name = "joint_state",
     .summary = "The encoders of a robot's joints: position and velocity of each.",
     .notes = "Radians and radians per second of a joint that turns, metres and metres per second of one that slides. "
              "The noise is in the unit of each joint.",
     .message = "sensor_msgs/msg/JointState",
     .attributes = rows_of<JointStateDesc>().table(),
     .create = create_sensor<JointStateSensor, JointStateDesc>,
     .outputs = joint_state_outputs,
     .sees_shapes = false});

}  // namespace

AttributeRows<JointStateDesc> JointStateDesc::rows() {
  using Desc = JointStateDesc;
  return {row(&Desc::part, AttributeKind::object, "part",
              "the part whose joints are measured, or ROOT for all; default: that of insert_at"),
          nested(&Desc::position, noise_rows("position_", "the position", "rad or m")),
          nested(&Desc::velocity, noise_rows("velocity_", "the velocity", "rad/s or m/s")), kRateAttribute};
}

void JointStateDesc::complete(const SensorContext& context) {
  if (!context.attributes.is_set("part")) part = context.insertion_point();
}

JointStateSensor::JointStateSensor(const std::string& name, const JointStateDesc& desc)
    : ReadingSensor({}),
      name_(name),
      desc_(desc),
      position_(desc.position, {desc.seed, name + "/position"}),
      velocity_(desc.velocity, {desc.seed, name + "/velocity"}) {}

void JointStateSensor::sense(const SensedWorld& world) {
  now_ = world.joints();
  if (!joints_.empty()) return;
  std::vector<KnownJoint> joints;
  for (const SensedJoint& joint : now_) joints.push_back({joint.name, joint.slides});
  if (joints.empty()) {
    throw InputError("sensor " + in_quotes(name_) + ": the part " + in_quotes(desc_.part) +
                     " has no joint, expected a part with elements of type joint, or ROOT for all joints");
  }
  know(std::move(joints));
}

void JointStateSensor::know(std::vector<KnownJoint> joints) {
  std::vector<TableColumn> columns;
  for (const KnownJoint& joint : joints) {
    for (TableColumn& column : joint_columns(joint.name, joint.slides)) columns.push_back(std::move(column));
  }
  joints_ = std::move(joints);
  set_columns(columns);
}

void JointStateSensor::archive(StateArchive& state) {
  std::vector<KnownJoint> joints = joints_;
  state(joints);
  if (joints.empty()) {
    joints_.clear();
  } else if (joints != joints_) {
    know(std::move(joints));
  }
}

void JointStateSensor::collect(const FrameTime& time, const FramePlan&, std::span<const PassResult>) {
  constexpr double kGone = std::numeric_limits<double>::quiet_NaN();
  const double period_s = sample_period_s(rate_hz, time);
  std::vector<double> values;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const auto joint = std::ranges::find(now_, joints_[i].name, &SensedJoint::name);
    const bool there = joint != now_.end();
    const auto axis = static_cast<std::uint32_t>(i);
    values.push_back(there ? position_.apply(joint->position, axis, time, period_s) : kGone);
    values.push_back(there ? velocity_.apply(joint->velocity, axis, time, period_s) : kGone);
  }
  set_reading(time, std::move(values));
}

}  // namespace simvis
