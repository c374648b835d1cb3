// The element `attachment`: two bodies, or a body and the world, hold together as a gripper or a suction cup holds.
//
//   <element type="attachment" name="GRIP" insert_at="palm" to="BOX" attached="0"/>
//
// Parameters  attached: 1 holds the other body where it stands, from the next step on; 0 lets go.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <simvis/element.h>
#include "elements/dynamics/world/world.h"

namespace simvis {

class DynamicObject;
class DynamicScene;

/// Two insertion points whose bodies hold together.
struct Attachment {
  std::string name;  ///< of its element
  std::string a, b;  ///< insertion points; ROOT: the world
  bool is_wanted = true;
  struct Held {
    std::size_t constraint;
    WorldLink a, b;  // b of the world: any
  };
  std::optional<Held> held{};  ///< in the world
};

/// All attachments of a scene.
class Attachments {
 public:
  void add(Attachment& attachment);
  void remove(Attachment& attachment);
  /// The one that holds the same two bodies' points; null if there is none.
  const Attachment* find(const std::string& a, const std::string& b) const;
  /// The world is a new one.
  void restart();
  /// Before the steps of a frame: attaches and releases what has changed. Those whose body has gone hold nothing.
  void act(DynamicsWorld& world, std::span<DynamicObject* const> objects);

 private:
  std::vector<Attachment*> attachments_;  // by name
  std::vector<std::size_t> released_;     // constraints of those that were removed
};

class AttachmentElement : public Element {
 public:
  /// Throws InputError: no physics; no body at a point; both are one body or link; no force moves either; another
  /// element attaches them already.
  explicit AttachmentElement(const ElementContext& context);
  ~AttachmentElement() override;
  void update(ParameterView values) override { attachment_.is_wanted = values[0] >= 0.5; }

 private:
  std::shared_ptr<DynamicScene> dynamic_;
  Attachment attachment_;
};

}  // namespace simvis
