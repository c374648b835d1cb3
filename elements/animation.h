// The element `animation`: plays an animation that is stored in a part's file.
//
//   <element type="animation" name="WALK" insert_at="ROOT" part="PERSON" clip="Walk" time="0.5"/>
//
// The element moves the part's nodes and deforms its skinned and morphed meshes. It changes this insertion of the part
// only. Several elements may play clips of one part at the same time if no two of them change the same node or mesh. An
// element that changes a node or mesh of another one is refused.
// Parameters  time (s), live: the position in the clip. Equal times give identical poses, to the last bit.
#pragma once

#include <memory>
#include <vector>

#include <simvis/element.h>
#include "scenegraph/part_player.h"

namespace simvis {

class AnimationElement : public Element {
 public:
  explicit AnimationElement(const ElementContext& context);
  void update(ParameterView values) override;
  /// The transforms and shapes that it changes.
  std::vector<const Node*> driven() const { return player_->driven(); }

 private:
  std::shared_ptr<PartPlayer> player_;
  bool loops_;
};

}  // namespace simvis
