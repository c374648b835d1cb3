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
#pragma once

#include <string>
#include <vector>

#include <simvis/reading_sensor.h>
#include <simvis/state_archive.h>
#include "sensors/described_sensor.h"
#include "sensors/noise_model.h"

namespace simvis {

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

}  // namespace simvis
