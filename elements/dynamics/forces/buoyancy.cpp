// The element `buoyancy`: still water that carries the body at the insertion point.
//
//   <element type="buoyancy" name="SEA" insert_at="BOAT" level="0.5"/>
//
// Parameters  level: height of the water (m); density (kg/m^3).
#include "elements/dynamics/forces/wrench_element.h"
#include "elements/dynamics/world/mass.h"
#include "elements/dynamics/world/submerged.h"
#include "scenegraph/language/attribute_rows.h"

namespace simvis {
namespace {

struct BuoyancyDesc {
  double level_m = 0, density_kg_m3 = 1000;

  static AttributeRows<BuoyancyDesc> rows();
};

class BuoyancyElement : public WrenchElement {
 public:
  /// Throws InputError: what WrenchElement throws, a body whose collision shapes have no volume.
  explicit BuoyancyElement(const ElementContext& context);
  void update(ParameterView values) override { rows_of<BuoyancyDesc>().set(desc_, values); }
  Wrench wrench(const PushedBody& body, const PhysicsStep& step) override;

 private:
  BuoyancyDesc desc_;
};

const ElementRegistration kBuoyancyRegistration({
    .name = "buoyancy",
    .summary = "Water that carries the body at its insertion point, by the volume that is submerged.",
    .notes =
        "Needs a dynamic body, or a link of a robot, before it at the insertion point. The surface of the water is "
        "a plane across gravity, which has no end. The volume is that of the collision shapes: exact for boxes, "
        "spheres and hulls, within 1e-8 for cylinders and capsules. Shapes that overlap count twice. The water "
        "stands still and has no drag and no added mass; an element drag resists the motion.",
    .attributes = rows_of<BuoyancyDesc>().table(),
    .create = create_element<BuoyancyElement>,
});

}  // namespace

AttributeRows<BuoyancyDesc> BuoyancyDesc::rows() {
  using Desc = BuoyancyDesc;
  return {row(&Desc::level_m, "level", "m", kPushedPlace, "height of the water in the world, against gravity").live(),
          row(&Desc::density_kg_m3, "density", "kg/m^3", {.min = 0, .max = 1e6}, "of the water").live()};
}

BuoyancyElement::BuoyancyElement(const ElementContext& context)
    : WrenchElement(context), desc_(rows_of<BuoyancyDesc>().read(context.attributes)) {
  if (mass_of(body(context).shapes, 1).mass_kg > 0) return;
  fail_at(context.command.where, "the collision shapes at " + in_quotes(point()) +
                                     " have no volume, expected a body or link with a solid shape");
}

Wrench BuoyancyElement::wrench(const PushedBody& body, const PhysicsStep& step) {
  const double gravity = glm::length(step.gravity_m_s2);
  if (!(gravity > 0)) return {};
  const glm::dvec3 up = -step.gravity_m_s2 / gravity;
  const glm::dmat4& pose = body.state.world_from_body;
  const SubmergedSolid wet =
      submerged(body.shapes, glm::transpose(glm::dmat3(pose)) * up, desc_.level_m - glm::dot(up, glm::dvec3(pose[3])));
  const glm::dvec3 center = glm::dvec3(pose * glm::dvec4(wet.center_m, 1));
  return wrench_at(center - body.state.center_m, desc_.density_kg_m3 * wet.volume_m3 * gravity * up);
}

}  // namespace simvis
