// The element `attachment`: two bodies, or a body and the world, hold together as a gripper or a suction cup holds.
//
//   <element type="attachment" name="GRIP" insert_at="palm" to="BOX" attached="0"/>
//
// Parameters  attached: 1 holds the other body where it stands, from the next step on; 0 lets go.
#pragma once

#include <memory>

#include <simvis/element.h>
#include "elements/dynamics/dynamic_scene.h"

namespace simvis {

class AttachmentElement : public Element {
 public:
  /// Throws InputError: no physics; no body at a point; both are one body or link; no force moves either; another
  /// element attaches these two insertion points already.
  explicit AttachmentElement(const ElementContext& context);
  ~AttachmentElement() override;
  void update(ParameterView values) override { attachment_.is_wanted = values[0] >= 0.5; }

 private:
  std::shared_ptr<DynamicScene> dynamic_;
  Attachment attachment_;
};

}  // namespace simvis
