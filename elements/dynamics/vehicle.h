// The element `vehicle`: the part at which it stands drives on wheels.
//
//   <element type="vehicle" name="DRIVE" insert_at="MARVIN" mass="30" wheel_radius="0.1" track="0.4" left="90"/>
//
// Frames      the part's: x forward, z up; the wheels stand on its plane z = 0.
// Joints      of the part's file may turn as the wheels do, so that cameras see them turn and a sensor joint_state
// reports
//             them: left_joints="wheel_left_joint". Physics then writes the values of these elements `joint`. One that
//             is set turns the wheel on from there.
// Parameters  x y z (m), roll pitch yaw (deg): as of an element `body`. Differential drive: left and right, the speeds
// of
//             the wheels (deg/s). Ackermann: speed of the rear wheels (deg/s) and steer, the angle of a wheel in the
//             middle of the front axle (deg, positive to the left).
#pragma once

#include <array>
#include <memory>
#include <vector>

#include <simvis/node.h>
#include "elements/command_source.h"
#include "elements/dynamics/dynamic_scene.h"
#include "elements/joint.h"
#include "elements/pose_rows.h"
#include "scenegraph/language/attribute_rows.h"

namespace simvis {

/// The drive of a vehicle, as its attributes say.
struct VehicleWheels {
  bool ackermann = false;
  double radius_m = 0.1, track_m = 0.4, wheelbase_m = 0.6, axle_m = 0, caster_m = -0.2, clearance_m = 0.03;
  double mass_kg = 1, friction = 1, max_torque_nm = 20;

  static AttributeRows<VehicleWheels> rows();
};

class VehicleElement : public Element, private DynamicObject {
 public:
  /// Throws InputError: no physics, no part, what body_rows.h says, a parameter of the other drive.
  explicit VehicleElement(const ElementContext& context);
  ~VehicleElement() override;
  void update(ParameterView values) override;
  void adapt_parameters(std::vector<AttributeSpec>& live_rows) const override;
  bool moves_itself() const override { return true; }
  void advance(std::int64_t time_ns, std::span<double> values) override;

  /// The values of its parameters with which it moves so, as far as its wheels allow.
  std::vector<ParameterSetting> settings_of(const VelocityCommand& command) const;

 private:
  void add_differential();
  void add_ackermann();
  void add_wheel(int parent, const glm::dvec3& at, bool spins, double friction);
  void add_steering(double y);
  void show_wheels(const ElementContext& context);
  std::size_t enter(DynamicsWorld& world, const glm::dmat4& world_from_point) override;
  void begin_steps(DynamicsWorld& world, const glm::dmat4& world_from_point) override;
  void before_step(DynamicsWorld& world, double share) override;
  DynamicParts parts() const override { return {.mass = &desc_.mass, .shapes = desc_.shapes, .links = desc_.links}; }

  // A joint of the part's file that turns as a wheel or a fork does.
  struct ShownJoint {
    std::shared_ptr<JointDriver> driver;
    std::size_t link = 0;                // in desc_
    double sign = 1;                     // -1: its axis points the other way
    double first_deg = 0, zero_deg = 0;  // its value where the link has not turned: at the start, and now
  };
  double shown_deg(const ShownJoint& joint) const;

  std::shared_ptr<DynamicScene> dynamic_;
  std::shared_ptr<Transform> transform_;
  VehicleWheels wheels_;
  ArticulationDesc desc_;
  std::vector<ShownJoint> shown_;  // keeps its place: drivers refer to its members
  bool entered_ = false, was_set_ = false;
  glm::dmat4 world_from_parent_{1.0};
  std::array<double, kPoseValues> written_{};
  double first_ = 0, second_ = 0;  // rad/s; of ackermann, the second is the angle in rad
};

}  // namespace simvis
