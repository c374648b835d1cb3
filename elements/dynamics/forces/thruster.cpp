// The element `thruster`: a force along an axis of a body, which follows its command with a lag.
//
//   <element type="thruster" name="PORT" insert_at="BOAT" point="-1 0.4 -0.2" thrust="20" time_constant="0.3"/>
//
// Frames      point and axis are in the frame of the insertion point.
// Parameters  thrust (N): the command.
#include "elements/dynamics/body_rows.h"
#include "elements/dynamics/forces/first_order_lag.h"
#include "elements/dynamics/forces/wrench_element.h"
#include "scenegraph/language/attribute_rows.h"

namespace simvis {
namespace {

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

const ElementRegistration kThrusterRegistration({
    .name = "thruster",
    .summary = "Pushes the body at its insertion point along an axis, as a propeller of a boat or a jet.",
    .notes = "Needs a dynamic body, or a link of a robot, before it at the insertion point. At the start the thrust is "
             "what is commanded. Each later command is approached as dT/dt = (command - T) / time_constant; the "
             "impulse of each step of physics is exact.",
    .attributes = rows_of<ThrusterDesc>().table(),
    .create = create_element<ThrusterElement>,
});

}  // namespace

AttributeRows<ThrusterDesc> ThrusterDesc::rows() {
  using Desc = ThrusterDesc;
  return {row(&Desc::point_m, "point", "m", kPushedPlace, "where the thrust acts, in the frame of the insertion point"),
          row(&Desc::axis, "axis", "", kAnyNumber, "direction of positive thrust, in the frame of the insertion point"),
          row(&Desc::time_constant_s, "time_constant", "s", kLagTime,
              "time in which the thrust comes nearer to its command by the share 1 - 1/e"),
          row(&Desc::thrust_n, "thrust", "N", kPushingForce, "commanded thrust; negative: against the axis").live()};
}

ThrusterElement::ThrusterElement(const ElementContext& context)
    : WrenchElement(context), desc_(rows_of<ThrusterDesc>().read(context.attributes)) {
  desc_.axis = unit_axis(context, "axis");
}

Wrench ThrusterElement::wrench(const PushedBody& body, const PhysicsStep& step) {
  const double thrust_n = lag_.advance(desc_.thrust_n, desc_.time_constant_s, step.length_s).value;
  return wrench_at(body.arm_m(desc_.point_m), thrust_n * body.direction(desc_.axis));
}

}  // namespace simvis
