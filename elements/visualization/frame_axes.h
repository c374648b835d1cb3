// The element `frame_axes`: arrows along the axes of the frame at its insertion point, for people: x red, y green, z
// blue.
//
//   <element type="frame_axes" name="AXES" insert_at="ROBOT" length="0.5"/>
//
// Only cameras with view="visualization" see them. They stand in the frame that the elements inserted before them make,
// and move with it.
// Parameters  length, width (m), both live.
#pragma once

#include <string>

#include <simvis/element.h>
#include "elements/visualization/marker_mesh.h"

namespace simvis {

class FrameAxesElement : public Element {
 public:
  explicit FrameAxesElement(const ElementContext& context);
  void update(ParameterView values) override;

 private:
  std::string name_;
  MarkerNodes nodes_;
};

}  // namespace simvis
