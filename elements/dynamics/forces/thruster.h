// The element `thruster`: a force along an axis of a body, which follows its command with a lag.
//
//   <element type="thruster" name="PORT" insert_at="BOAT" point="-1 0.4 -0.2" thrust="20" time_constant="0.3"/>
//
// Frames      point and axis are in the frame of the insertion point.
// Parameters  thrust (N): the command.
#pragma once

#include "elements/dynamics/forces/first_order_lag.h"
#include "elements/dynamics/forces/wrench_element.h"
#include "scenegraph/language/attribute_rows.h"

namespace simvis {

struct ThrusterDesc {
  glm::dvec3 point_m{0}, axis{1, 0, 0};
  double time_constant_s = 0, thrust_n = 0;

  static AttributeRows<ThrusterDesc> rows();
};

class ThrusterElement : public WrenchElement, public Stateful {
 public:
  /// Throws InputError: what WrenchElement throws, an axis without a length.
  explicit ThrusterElement(const ElementContext& context);
  void update(ParameterView values) override { rows_of<ThrusterDesc>().set(desc_, values); }
  Wrench wrench(const PushedBody& body, const PhysicsStep& step) override;
  void restart() override { lag_.restart(); }
  void archive(StateArchive& state) override { state(lag_); }

 private:
  ThrusterDesc desc_;
  FirstOrderLag lag_;  // of the thrust in N
};

}  // namespace simvis
