// The element `scale`: makes what follows its insertion point larger or smaller.
//
//   <element type="scale" name="GROW" insert_at="PLANT" x="2" y="2" z="2"/>
//
// Parameters  x y z (live): factors along the axes of the insertion point's frame. Above 0: a sensor that stands on
//          what is mirrored would have a left-handed frame, and one on what is scaled to nothing none at all.
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
