// The element `rotor`: the thrust and the torque of a propeller in still air, by its speed.
//
//   <element type="rotor" name="FRONT" insert_at="CRAFT" point="0.2 0.2 0.05" turns="ccw" thrust_constant="8.5e-6"
//   torque_constant="1.4e-7" time_constant="0.02" speed="30000"/>
//
// Frames      point and axis are in the frame of the insertion point.
// Parameters  speed (deg/s): the command of the motor.
#pragma once

#include "elements/dynamics/forces/first_order_lag.h"
#include "elements/dynamics/forces/wrench_element.h"
#include "scenegraph/language/attribute_rows.h"

namespace simvis {

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

}  // namespace simvis
