// The element `drag`: the resistance of air or water against the motion of a body.
//
//   <element type="drag" name="AIR" insert_at="BALL" area="0.03" coefficient="0.47"/>
//
// Parameters  linear, area, coefficient, density.
#include <algorithm>
#include <optional>
#include <string>

#include "elements/dynamics/forces/wind.h"
#include "elements/dynamics/forces/wrench_element.h"
#include "scenegraph/language/attribute_rows.h"

namespace simvis {
namespace {

struct DragDesc {
  std::optional<glm::dvec3> point_m{};  ///< none: the centre of mass
  std::string wind{};
  double linear_n_s_m = 0, area_m2 = 0, coefficient = 1, density_kg_m3 = 1.225;

  static AttributeRows<DragDesc> rows();
};

class DragElement : public WrenchElement {
 public:
  /// Throws InputError: what WrenchElement throws, an element that is no wind.
  explicit DragElement(const ElementContext& context);
  void update(ParameterView values) override { rows_of<DragDesc>().set(desc_, values); }
  Wrench wrench(const PushedBody& body, const PhysicsStep& step) override;

 private:
  DragDesc desc_;
  const WindElement* wind_ = nullptr;  // the scene keeps it as long as this element; null: still air
};

const ElementRegistration kDragRegistration({
    .name = "drag",
    .summary = "Resists the motion of the body at its insertion point through air or water.",
    .notes = "Needs a dynamic body, or a link of a robot, before it at the insertion point. The force is -(linear + "
             "density coefficient area |v| / 2) v, where v is the velocity of the point relative to the wind, or to "
             "still air, at the beginning of each step of physics. All drags of a body together stop it in no less "
             "than a step, so that no drag makes a body unstable.",
    .attributes = rows_of<DragDesc>().table(),
    .create = create_element<DragElement>,
});

// The mass with which a free body resists a force along a unit vector at this place.
double mass_at(const PushedBody& body, const glm::dvec3& arm_m, const glm::dvec3& along) {
  const glm::dmat3 turn(body.state.world_from_body);
  const glm::dvec3 moment = glm::transpose(turn) * glm::cross(arm_m, along);
  return 1 / (1 / body.mass.mass_kg + glm::dot(moment, glm::inverse(body.mass.inertia_kg_m2) * moment));
}

}  // namespace

AttributeRows<DragDesc> DragDesc::rows() {
  using Desc = DragDesc;
  constexpr AttributeLimits kSize{.min = 0, .max = 1e9};
  return {row(&Desc::point_m, "point", "m", kPushedPlace,
              "where the force acts, in the frame of the insertion point; default: the centre of mass"),
          row(&Desc::wind, AttributeKind::element, "wind", "element of type wind; default: the air stands still"),
          row(&Desc::linear_n_s_m, "linear", "N s/m", kSize, "force per speed, as in a slow viscous flow").live(),
          row(&Desc::area_m2, "area", "m^2", kSize, "area across the flow, for the force by the square of the speed")
              .live(),
          row(&Desc::coefficient, "coefficient", "", kSize, "drag coefficient of the shape for this area").live(),
          row(&Desc::density_kg_m3, "density", "kg/m^3", kSize, "of the air or water").live()};
}

DragElement::DragElement(const ElementContext& context)
    : WrenchElement(context), desc_(rows_of<DragDesc>().read(context.attributes)) {
  if (desc_.wind.empty()) return;
  wind_ = dynamic_cast<const WindElement*>(context.find_element(desc_.wind));
  if (wind_ != nullptr) return;
  fail_at(context.attributes.where("wind"), "attribute \"wind\": " + in_quotes(desc_.wind) +
                                                " is not allowed, expected the name of an element of type wind");
}

// A link that joints hold yields less than a free body, so the bound of a free body holds for it too.
Wrench DragElement::wrench(const PushedBody& body, const PhysicsStep& step) {
  const glm::dvec3 arm = desc_.point_m ? body.arm_m(*desc_.point_m) : glm::dvec3(0);
  const glm::dvec3 air = wind_ == nullptr ? glm::dvec3(0) : wind_->velocity_m_s(step.begin_s);
  const glm::dvec3 velocity = body.velocity_at(arm) - air;
  const double speed = glm::length(velocity);
  if (!(speed > 0)) return {};
  const double wanted = desc_.linear_n_s_m + desc_.density_kg_m3 * desc_.coefficient * desc_.area_m2 * speed / 2;
  const double force_per_speed =
      std::min(wanted, mass_at(body, arm, velocity / speed) / (step.length_s * body.sharing));
  return wrench_at(arm, -force_per_speed * velocity);
}

}  // namespace simvis
