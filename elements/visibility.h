// The element `visibility`: shows or hides everything after its insertion point.
//
//   <element type="visibility" name="SHOW" insert_at="DOOR" visible="0"/>
//
// Parameters  visible (live): shapes and lights are shown from 0.5 up, so that a trajectory may go from 0 to 1 between
//          two rows. If an outer visibility element hides them, an inner one cannot show them. Sensors after the
//          element keep measuring.
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
