// The sensor `joint_state`: the encoders of a robot's joints.
//
//   <sensor type="joint_state" name="JOINTS" insert_at="ARM" rate="50" position_precision="0.0015"/>
//
// Joints   are the elements of type `joint` and `mimic_joint` of the part `part`, those in its file included, in the
//          order of their commands. The first measurement decides which joints there are; one that is removed later
//          has no values.
// Values   JOINT.position_rad and JOINT.velocity_rad_s of a joint that turns, JOINT.position_m and JOINT.velocity_m_s
//          of one that slides. The velocity is that at the stamp where physics moves the joint, else the mean
//          since the previous frame; 0 at the first.
// Efforts  JOINT.effort_n_m or JOINT.effort_n of a joint that physics moves: what its drive exerts in the last step
//          before the frame, without friction, damping and springs of the joint itself. 0 without a drive.
// Noise    of positions and velocities, in the unit of each joint: sensors/noise_model.h.
// Message  sensor_msgs/JointState; its list of efforts is empty if no joint has one.
#include <algorithm>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <simvis/reading_sensor.h>
#include <simvis/state_archive.h>
#include "sensors/described_sensor.h"
#include "sensors/noise_model.h"

namespace simvis {
namespace {

struct JointStateDesc {
  std::string part = "ROOT";
  NoiseDesc position{}, velocity{};
  std::uint64_t seed = 0;

  static AttributeRows<JointStateDesc> rows();
  /// Its part by default is that of insert_at.
  void complete(const SensorContext& context);
};

class JointStateSensor : public ReadingSensor, public Stateful {
 public:
  JointStateSensor(const std::string& name, const JointStateDesc& desc);

  SensorNeeds needs() const override { return {.joints_of = desc_.part}; }
  /// Throws InputError if the part has no joint at the first measurement.
  void sense(const SensedWorld& world) override;
  void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) override;
  /// The joints that the first measurement has found.
  void archive(StateArchive& state) override;
  std::string method() const override { return "values of joints"; }

 private:
  struct KnownJoint {
    std::string name;
    bool slides = false, has_effort = false;
    bool operator==(const KnownJoint&) const = default;
    void archive(StateArchive& state) { state(name, slides, has_effort); }
  };
  void know(std::vector<KnownJoint> joints);

  std::string name_;
  JointStateDesc desc_;
  NoiseModel position_, velocity_;
  std::vector<KnownJoint> joints_;  // in the order of the columns
  std::vector<SensedJoint> now_;
};

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
