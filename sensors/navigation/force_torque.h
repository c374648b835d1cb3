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
#pragma once

#include <string>

#include <simvis/reading_sensor.h>
#include "sensors/described_sensor.h"
#include "sensors/noise_model.h"

namespace simvis {

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

}  // namespace simvis
