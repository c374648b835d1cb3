// The element `scale`: makes everything after its insertion point larger or smaller.
//
//   <element type="scale" name="GROW" insert_at="PLANT" x="2" y="2" z="2"/>
//
// Parameters  x y z (live): factors along the axes of the insertion point's frame. They are above 0: with a negative
//          factor a sensor after the element would have a left-handed frame, and with a factor of 0 it would have no
//          frame.
#pragma once

#include <simvis/element.h>
#include <simvis/node.h>

namespace simvis {

class ScaleElement : public Element {
 public:
  explicit ScaleElement(const ElementContext& context);
  void update(ParameterView values) override;

 private:
  std::shared_ptr<Transform> transform_;
};

}  // namespace simvis
