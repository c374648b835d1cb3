// The sensor `force_torque`: what a joint of a robot in physics carries.
//
//   <sensor type="force_torque" name="WRIST_FT" insert_at="FOREARM" joint="wrist" force_stddev="0.1"/>
//
// Values   force_{x,y,z}_n and torque_{x,y,z}_n_m: what the link behind the joint exerts on the link in front of it, as
//          SDF's measure_direction "child_to_parent" says: an arm at rest shows its weight, downwards. Along the axes
//          of the sensor frame, and about its origin: a sensor at the child link without an offset gives the torque
//          about the joint's origin.
// Time     means of the last step of physics; 0 before the first one. Where joints move fast or bodies collide, let
//          frames be as dense as the steps.
// Friction between links behind the joint and other bodies is not known to it: where these links slide or are held by
//          friction, its force counts as load of the joint.
// Joints   of an element robot: those that move by `joint`, and fixed ones that its kept_joints names by `fixed_joint`.
//          Physics knows no other fixed joints.
// Noise    sensors/noise_model.h, for forces and for torques.
// Message  geometry_msgs/WrenchStamped.
#include <memory>
#include <string>
#include <utility>

#include <simvis/reading_sensor.h>
#include "sensors/described_sensor.h"
#include "sensors/noise_model.h"
#include "sensors/without_physics.h"

namespace simvis {
namespace {

struct ForceTorqueDesc {
  std::string joint;  ///< an element of type joint, or a fixed joint
  NoiseDesc force{}, torque{};
  bool needs_physics = true;
  std::uint64_t seed = 0;

  static AttributeRows<ForceTorqueDesc> rows();
};

class ForceTorque : public ReadingSensor {
 public:
  ForceTorque(std::string name, const ForceTorqueDesc& desc);

  SensorNeeds needs() const override { return {.load_of = desc_.joint}; }
  /// Throws InputError if no robot of physics has the joint, and one has to.
  void sense(const SensedWorld& world) override;
  void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) override;
  std::string method() const override { return "constraint forces of physics"; }

 private:
  std::string name_;
  ForceTorqueDesc desc_;
  NoiseModel force_, torque_;
  JointLoad load_;  // of this frame
};

const std::vector<TableColumn> kForceTorqueColumns{
    {.name = "force_x_n",
     .format = "%.12g",
     .unit = "N",
     .meaning = "force of the link behind the joint on the one in front, along x",
     .frame = "sensor"},
    {.name = "force_y_n",
     .format = "%.12g",
     .unit = "N",
     .meaning = "force of the link behind the joint on the one in front, along y",
     .frame = "sensor"},
    {.name = "force_z_n",
     .format = "%.12g",
     .unit = "N",
     .meaning = "force of the link behind the joint on the one in front, along z",
     .frame = "sensor"},
    {.name = "torque_x_n_m",
     .format = "%.12g",
     .unit = "N m",
     .meaning = "its torque about the origin, about x",
     .frame = "sensor"},
    {.name = "torque_y_n_m",
     .format = "%.12g",
     .unit = "N m",
     .meaning = "its torque about the origin, about y",
     .frame = "sensor"},
    {.name = "torque_z_n_m",
     .format = "%.12g",
     .unit = "N m",
     .meaning = "its torque about the origin, about z",
     .frame = "sensor"}};

std::unique_ptr<Sensor> create_force_torque(const SensorContext& context) {
  const CommandAttribute* const fixed = context.command.find("fixed_joint");
  if (fixed == nullptr) context.command.require("joint");  // throws if it is missing
  if (fixed != nullptr && context.command.find("joint") != nullptr) {
    fail_at(fixed->where, "attribute \"fixed_joint\" is not allowed beside \"joint\", expected one of them");
  }
  return create_sensor<ForceTorque, ForceTorqueDesc>(context);
}

const SensorRegistration kForceTorqueRegistration(
    {.name = "force_torque",
     .summary = "The force and the torque that a joint of a robot in physics carries.",
     .notes =
         "What the link behind the joint exerts on the link in front of it, along the axes of the sensor frame and "
         "about its origin: an arm at rest shows its weight.",
     .message = "geometry_msgs/msg/WrenchStamped",
     .attributes = rows_of<ForceTorqueDesc>().table(),
     .create = create_force_torque,
     .outputs = column_outputs_of<kForceTorqueColumns>,
     .sees_shapes = false});

}  // namespace

AttributeRows<ForceTorqueDesc> ForceTorqueDesc::rows() {
  using Desc = ForceTorqueDesc;
  return {row(&Desc::joint, AttributeKind::element, "joint", "the element of type joint that is measured"),
          row(&Desc::joint, AttributeKind::text, "fixed_joint",
              "instead of joint: a fixed joint that kept_joints of an element robot names"),
          nested(&Desc::force, noise_rows("force_", "each force", "N")),
          nested(&Desc::torque, noise_rows("torque_", "each torque", "N m")),
          without_physics_row(&Desc::needs_physics),
          kRateAttribute};
}

ForceTorque::ForceTorque(std::string name, const ForceTorqueDesc& desc)
    : ReadingSensor(kForceTorqueColumns),
      name_(std::move(name)),
      desc_(desc),
      force_(desc.force, {desc.seed, name_ + "/force"}),
      torque_(desc.torque, {desc.seed, name_ + "/torque"}) {}

void ForceTorque::sense(const SensedWorld& world) {
  const std::optional<JointLoad> load = world.joint_load();
  if (!load && desc_.needs_physics) {
    throw InputError("sensor " + in_quotes(name_) + ": no robot of physics moves the joint " + in_quotes(desc_.joint) +
                     ", expected a joint of a part with an element robot");
  }
  load_ = load.value_or(JointLoad());
}

void ForceTorque::collect(const FrameTime& time, const FramePlan&, std::span<const PassResult>) {
  const glm::dmat3 sensor_from_world = glm::transpose(glm::dmat3(world_from_sensor()));
  const glm::dvec3 lever_m = load_.point_m - glm::dvec3(world_from_sensor()[3]);
  const glm::dvec3 force_n = sensor_from_world * load_.force_n,
                   torque_nm = sensor_from_world * (load_.torque_nm + glm::cross(lever_m, load_.force_n));
  const double period_s = sample_period_s(rate_hz, time);
  std::vector<double> values;
  values.reserve(6);
  for (glm::length_t axis = 0; axis < 3; ++axis) {
    values.push_back(force_.apply(force_n[axis], static_cast<std::uint32_t>(axis), time, period_s));
  }
  for (glm::length_t axis = 0; axis < 3; ++axis) {
    values.push_back(torque_.apply(torque_nm[axis], static_cast<std::uint32_t>(axis), time, period_s));
  }
  set_reading(time, std::move(values));
}

}  // namespace simvis
