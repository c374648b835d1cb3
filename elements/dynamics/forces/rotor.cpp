// The element `rotor`: the thrust and the torque of a propeller in still air, by its speed.
//
//   <element type="rotor" name="FRONT" insert_at="CRAFT" point="0.2 0.2 0.05" turns="ccw" thrust_constant="8.5e-6"
//   torque_constant="1.4e-7" time_constant="0.02" speed="30000"/>
//
// Frames      point and axis are in the frame of the insertion point.
// Parameters  speed (deg/s): the command of the motor.
#include <glm/trigonometric.hpp>

#include "elements/dynamics/body_rows.h"
#include "elements/dynamics/forces/first_order_lag.h"
#include "elements/dynamics/forces/wrench_element.h"
#include "scenegraph/language/attribute_rows.h"

namespace simvis {
namespace {

struct RotorDesc {
  glm::dvec3 point_m{0}, axis{0, 0, 1};
  bool is_clockwise = false;
  double thrust_n_s2 = 0, torque_nm_s2 = 0;  ///< per square of the speed in rad/s
  double time_constant_s = 0, speed_rad_s = 0;

  static AttributeRows<RotorDesc> rows();
};

class RotorElement : public WrenchElement, public Stateful {
 public:
  /// Throws InputError: what WrenchElement throws, an axis without a length.
  explicit RotorElement(const ElementContext& context);
  void update(ParameterView values) override { rows_of<RotorDesc>().set(desc_, values); }
  Wrench wrench(const PushedBody& body, const PhysicsStep& step) override;
  void restart() override { lag_.restart(); }
  void archive(StateArchive& state) override { state(lag_); }

 private:
  RotorDesc desc_;
  FirstOrderLag lag_;  // of the speed in rad/s
};

constexpr double kMaxRotorSpeed_deg_s = 1e7;
constexpr AttributeUnit kDegreesPerSecond{"deg/s", glm::radians(1.0)};  // of a member in rad/s
constexpr AttributeLimits kRotorConstant{.min = 0, .max = 1e6};

const ElementRegistration kRotorRegistration({
    .name = "rotor",
    .summary = "Lifts the body at its insertion point as a propeller does, by the square of its speed.",
    .notes =
        "Needs a dynamic body, or a link of a robot, before it at the insertion point. The thrust along the axis is "
        "thrust_constant w^2, the torque against the sense of rotation torque_constant w^2, with w in rad/s, as in "
        "still air. At the start the speed is what is commanded. Each later command is approached as dw/dt = "
        "(command - w) / time_constant; the impulses of each step of physics are exact. The mass of the propeller "
        "is part of the body, and its angular momentum is left out.",
    .attributes = rows_of<RotorDesc>().table(),
    .create = create_element<RotorElement>,
});

}  // namespace

AttributeRows<RotorDesc> RotorDesc::rows() {
  using Desc = RotorDesc;
  return {
      row(&Desc::point_m, "point", "m", kPushedPlace, "the rotor's hub, in the frame of the insertion point"),
      row(&Desc::axis, "axis", "", kAnyNumber, "direction of the thrust, in the frame of the insertion point"),
      row(&Desc::is_clockwise, "turns", {{false, "ccw"}, {true, "cw"}},
          "seen against the axis, so from above for a lifting rotor: ccw or cw"),
      row(&Desc::thrust_n_s2, "thrust_constant", "N s^2", kRotorConstant, "thrust per square of the speed in rad/s"),
      row(&Desc::torque_nm_s2, "torque_constant", "N m s^2", kRotorConstant,
          "torque on the body per square of the speed in rad/s"),
      row(&Desc::time_constant_s, "time_constant", "s", kLagTime,
          "time in which the speed comes nearer to its command by the share 1 - 1/e"),
      row(&Desc::speed_rad_s, "speed", kDegreesPerSecond, {.min = 0, .max = kMaxRotorSpeed_deg_s},
          "commanded speed of the motor")
          .live()};
}

RotorElement::RotorElement(const ElementContext& context)
    : WrenchElement(context), desc_(rows_of<RotorDesc>().read(context.attributes)) {
  desc_.axis = unit_axis(context, "axis");
}

Wrench RotorElement::wrench(const PushedBody& body, const PhysicsStep& step) {
  const double square = lag_.advance(desc_.speed_rad_s, desc_.time_constant_s, step.length_s).square;
  const glm::dvec3 axis = body.direction(desc_.axis);
  Wrench wrench = wrench_at(body.arm_m(desc_.point_m), desc_.thrust_n_s2 * square * axis);
  wrench.torque_nm += (desc_.is_clockwise ? 1 : -1) * desc_.torque_nm_s2 * square * axis;
  return wrench;
}

}  // namespace simvis
