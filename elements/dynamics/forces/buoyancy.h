// The element `buoyancy`: still water that carries the body at the insertion point.
//
//   <element type="buoyancy" name="SEA" insert_at="BOAT" level="0.5"/>
//
// Parameters  level: height of the water (m); density (kg/m^3).
#pragma once

#include "elements/dynamics/forces/wrench_element.h"
#include "scenegraph/language/attribute_rows.h"

namespace simvis {

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

}  // namespace simvis
