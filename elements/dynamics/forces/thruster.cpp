#include "elements/dynamics/forces/thruster.h"

#include "elements/dynamics/body_rows.h"

namespace simvis {
namespace {

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
