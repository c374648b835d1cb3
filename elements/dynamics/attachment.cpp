// The element `attachment`: two bodies, or a body and the world, hold together as a gripper or a suction cup holds.
//
//   <element type="attachment" name="GRIP" insert_at="palm" to="BOX" attached="0"/>
//
// Parameters  attached: 1 holds the other body where it stands, from the next step on; 0 lets go.
#include <memory>

#include <simvis/element.h>
#include <simvis/error.h>
#include <simvis/node.h>
#include "elements/dynamics/dynamic_scene.h"

namespace simvis {
namespace {

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

constexpr AttributeSpec kAttachmentRows[] = {
    {.name = "to",
     .kind = AttributeKind::object,
     .text = "required: the part or link that is attached to the one at the insertion point; ROOT: the world"},
    {.name = "attached",
     .default_value = "1",
     .text = "1 holds the other body in the pose in which it stands, 0 lets go of it",
     .min = 0,
     .max = 1,
     .live = true},
};

const ElementRegistration kAttachmentRegistration({
    .name = "attachment",
    .summary = "Attaches a body to another one, to a link of a robot or to the world, as a gripper or a tow bar does.",
    .notes =
        "Needs the bodies before it. They keep the pose to each other that they have when attached becomes 1, "
        "wherever they stand, and do not collide with each other until attached becomes 0. Neither changes their "
        "poses, nor the momentum of both together; a difference of their speeds goes at once. What another element "
        "or a client puts elsewhere meanwhile is drawn back at no more than 1 m/s and 5 rad/s.",
    .attributes = kAttachmentRows,
    .create = create_element<AttachmentElement>,
});

}  // namespace

AttachmentElement::AttachmentElement(const ElementContext& context)
    : dynamic_(find_dynamic_scene(context)),
      attachment_{.name = context.command.require("name").value,
                  .a = context.command.require("insert_at").value,
                  .b = context.command.require("to").value} {
  const Location& where = context.command.require("to").where;
  const auto body_at = [&](std::string_view attribute) {
    return dynamic_->require_body(context.command.require(attribute));
  };
  const StandingBody a = body_at("insert_at");
  const StandingBody b = attachment_.b == kAttachedWorld ? StandingBody() : body_at("to");
  if (a.object == b.object && a.link == b.link) {
    fail_at(where, in_quotes(attachment_.b) + " and " + in_quotes(attachment_.a) +
                       " are one body, expected another body or link, or ROOT");
  }
  if (!a.is_moved() && !b.is_moved()) {
    fail_at(where, "no force moves " + in_quotes(attachment_.a) + " or " + in_quotes(attachment_.b) +
                       ", expected one that forces move");
  }
  // One that the same request has removed lives until the request ends, without its node.
  const Attachment* const other = dynamic_->attachments().find(attachment_.a, attachment_.b);
  if (other != nullptr && context.scene.find_node(other->name) != nullptr) {
    fail_at(where, "element " + in_quotes(other->name) + " attaches " + in_quotes(attachment_.a) + " and " +
                       in_quotes(attachment_.b) + " already, expected one element for two bodies");
  }
  const auto mark = std::make_shared<Group>();
  mark->name = attachment_.name;
  context.scene.insert(context.command, mark);
  dynamic_->attachments().add(attachment_);
}

AttachmentElement::~AttachmentElement() { dynamic_->attachments().remove(attachment_); }

}  // namespace simvis
