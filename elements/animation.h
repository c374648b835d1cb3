// The element `animation`: plays an animation that a part's file brings along.
//
//   <element type="animation" name="WALK" insert_at="ROOT" part="PERSON" clip="Walk" time="0.5"/>
//
// Moves the part's nodes and bends its skinned and morphed meshes, in this insertion of the part alone. Several
// elements may play clips of one part at once, as long as no two of them change the same node or mesh: that is refused.
// Parameters  time (s), live: where in the clip the part is. At equal times it looks the same, to the last bit.
#pragma once

#include <memory>

#include <simvis/element.h>
#include "scenegraph/part_player.h"

namespace simvis {

class AnimationElement : public Element {
 public:
  explicit AnimationElement(const ElementContext& context);
  void update(ParameterView values) override;

 private:
  std::shared_ptr<PartPlayer> player_;
  bool loops_;
};

}  // namespace simvis
