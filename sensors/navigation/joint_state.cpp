#include "sensors/navigation/joint_state.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

namespace simvis {

namespace {

// Of one joint.
std::vector<TableColumn> joint_columns(const std::string& joint, bool slides, bool has_effort) {
  constexpr double kGone = std::numeric_limits<double>::quiet_NaN();
  const std::string unit = slides ? "m" : "rad", motion = slides ? " that slides" : " that turns";
  std::vector<TableColumn> columns{{.name = joint + ".position_" + unit,
                                    .format = "%.12g",
                                    .unit = unit,
                                    .meaning = "position of each joint" + motion,
                                    .nothing = kGone},
                                   {.name = joint + ".velocity_" + unit + "_s",
                                    .format = "%.12g",
                                    .unit = unit + "/s",
                                    .meaning = "velocity of each joint" + motion,
                                    .nothing = kGone}};
  if (has_effort) {
    columns.push_back({.name = joint + (slides ? ".effort_n" : ".effort_n_m"),
                       .format = "%.12g",
                       .unit = slides ? "N" : "N m",
                       .meaning = "effort of the drive of each joint" + motion + " by physics",
                       .nothing = kGone});
  }
  return columns;
}

std::vector<OutputSpec> joint_state_outputs(const SensorContext& context) {
  std::vector<TableColumn> columns = joint_columns("*", false, true);
  for (TableColumn& column : joint_columns("*", true, true)) columns.push_back(std::move(column));
  return reading_outputs(context, columns);
}

const SensorRegistration kJointStateRegistration(
    {.name = "joint_state",
     .summary = "The encoders of a robot's joints: position and velocity of each, and in physics its effort.",
     .notes = "Radians, radians per second and N m of a joint that turns, metres, metres per second and N of one that "
              "slides. The effort is what the joint's drive exerts in the last step before the frame. "
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
  for (const SensedJoint& joint : now_) joints.push_back({joint.name, joint.slides, joint.effort.has_value()});
  if (joints.empty()) {
    throw InputError("sensor " + in_quotes(name_) + ": the part " + in_quotes(desc_.part) +
                     " has no joint, expected a part with elements of type joint, or ROOT for all joints");
  }
  know(std::move(joints));
}

void JointStateSensor::know(std::vector<KnownJoint> joints) {
  std::vector<TableColumn> columns;
  for (const KnownJoint& joint : joints) {
    for (TableColumn& column : joint_columns(joint.name, joint.slides, joint.has_effort))
      columns.push_back(std::move(column));
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
    if (joints_[i].has_effort) values.push_back(there ? joint->effort.value_or(kGone) : kGone);
  }
  set_reading(time, std::move(values));
}

}  // namespace simvis
