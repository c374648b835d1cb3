// The element `drag`: the resistance of air or water against the motion of a body.
//
//   <element type="drag" name="AIR" insert_at="BALL" area="0.03" coefficient="0.47"/>
//
// Parameters  linear, area, coefficient, density.
#pragma once

#include <optional>
#include <string>

#include "elements/dynamics/forces/wind.h"
#include "elements/dynamics/forces/wrench_element.h"
#include "scenegraph/language/attribute_rows.h"

namespace simvis {

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

}  // namespace simvis
