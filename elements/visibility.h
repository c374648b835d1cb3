// The element `visibility`: shows or hides what follows its insertion point.
//
//   <element type="visibility" name="SHOW" insert_at="DOOR" visible="0"/>
//
// Parameters  visible (live): shapes and lights are there from one half up, so that a trajectory may go from 0 to 1
//          between two rows. Hidden within hidden stays hidden. Sensors that follow keep measuring.
#pragma once

#include <simvis/element.h>
#include <simvis/node.h>

namespace simvis {

class VisibilityElement : public Element {
 public:
  explicit VisibilityElement(const ElementContext& context);
  void update(ParameterView values) override;

 private:
  std::shared_ptr<Visibility> node_;
};

}  // namespace simvis
