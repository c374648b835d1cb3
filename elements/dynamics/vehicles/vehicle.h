// The element `vehicle`: the part at which it stands drives on wheels.
//
//   <element type="vehicle" name="DRIVE" insert_at="MARVIN" mass="30" wheel_radius="0.1" track="0.4" left="90"/>
//
// Frames      the part's: x forward, z up; the wheels stand on its plane z = 0.
// Joints      of the part's file may turn as the wheels do, so that cameras see them turn and a sensor joint_state
//             reports them: left_joints="wheel_left_joint". Physics then writes the values of these elements `joint`.
//             If the value of such a joint is set, the shown wheel continues from that value.
// Parameters  x y z (m), roll pitch yaw (deg): as of an element `body`. Differential drive and tracks: left and right,
//             the speeds of the wheels (deg/s). Ackermann: speed of the rear wheels (deg/s) and steer, the angle of a
//             wheel in the middle of the front axle (deg, positive to the left). Mecanum: front_left, front_right,
//             rear_left, rear_right; omni: wheel_1, wheel_2, wheel_3 (deg/s).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include <simvis/node.h>
#include "elements/command_source.h"
#include "elements/dynamics/dynamic_scene.h"
#include "elements/dynamics/vehicles/vehicle_surfaces.h"
#include "elements/joint.h"
#include "elements/pose_rows.h"
#include "scenegraph/language/attribute_rows.h"

namespace simvis {

/// The drive of a vehicle, as its attributes say.
struct VehicleWheels {
  enum class Drive : std::uint8_t { differential, ackermann, mecanum, omni, tracked } drive = Drive::differential;
  double radius_m = 0.1, track_m = 0.4, wheelbase_m = 0.6, axle_m = 0, caster_m = -0.2, clearance_m = 0.03;
  double width_m = 0.1;
  double mass_kg = 1, friction = 1, max_torque_nm = 20;

  bool is_differential() const { return drive == Drive::differential; }
  bool is_ackermann() const { return drive == Drive::ackermann; }
  bool is_mecanum() const { return drive == Drive::mecanum; }
  bool is_omni() const { return drive == Drive::omni; }
  bool is_tracked() const { return drive == Drive::tracked; }
  bool has_sides() const { return is_differential() || is_tracked(); }
  bool has_motors() const { return is_differential() || is_ackermann(); }
  bool has_wheelbase() const { return is_ackermann() || is_mecanum() || is_tracked(); }
  static AttributeRows<VehicleWheels> rows();
};

class VehicleElement : public Element, public Stateful, private DynamicObject {
 public:
  /// Throws InputError: no physics, no part, what body_rows.h says, an attribute or a parameter of another drive. Of a
  /// joint: a name that is no element `joint`, another axis, a part that is off, limits of a wheel's joint, or
  /// something else that moves it.
  explicit VehicleElement(const ElementContext& context);
  ~VehicleElement() override;
  void update(ParameterView values) override;
  void adapt_parameters(std::vector<AttributeSpec>& live_rows) const override;
  bool moves_itself() const override { return true; }
  void advance(std::int64_t time_ns, std::span<double> values) override;
  void archive(StateArchive& state) override {
    state.finite(desc_.world_from_base, world_from_parent_);
    state(entered_, was_set_, written_);
    for (ShownJoint& each : shown_) {
      state.finite(each.first_deg, each.zero_deg);
      state(each.driver->was_set);  // again, since a world that is made anew forgets it
    }
  }

  /// Returns the values of its parameters for this command, within the limits of its wheels.
  std::vector<ParameterSetting> settings_of(const VelocityCommand& command) const;

 private:
  static constexpr std::size_t kMaxSpeeds = 4;
  void add_differential();
  void add_ackermann();
  void add_wheel(int parent, const glm::dvec3& at, bool spins, double friction);
  void add_steering(double y);
  void add_surfaces(std::vector<VehicleSurface> surfaces);
  void drive_wheels(DynamicsWorld& world) const;
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
  std::array<double, kMaxSpeeds> speeds_{};  // rad/s; of ackermann, the second is the angle in rad
  std::vector<VehicleSurface> surfaces_;     // of mecanum, omni and tracked; the number of its part is its place + 1
};

}  // namespace simvis
