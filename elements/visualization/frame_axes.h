// The element `frame_axes`: shows the axes of the frame at its insertion point as arrows: x red, y green, z blue.
//
//   <element type="frame_axes" name="AXES" insert_at="ROBOT" length="0.5"/>
//
// Only cameras with view="visualization" see the arrows. The arrows show the frame after all elements that were
// inserted before them, and move with it.
// Parameters  length, width (m), both live.
#pragma once

#include <string>

#include <simvis/element.h>
#include "elements/visualization/marker_mesh.h"

namespace simvis {

struct FrameAxesLook {
  double length_m = 0.5, width_m = 0.02;
};

class FrameAxesElement : public Element {
 public:
  explicit FrameAxesElement(const ElementContext& context);
  void update(ParameterView values) override;

 private:
  std::string name_;
  MarkerNodes nodes_;
};

}  // namespace simvis
