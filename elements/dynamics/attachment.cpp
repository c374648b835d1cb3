#include "elements/dynamics/attachment.h"

#include <algorithm>
#include <utility>

#include <simvis/error.h>
#include <simvis/node.h>
#include "elements/dynamics/dynamic_scene.h"
#include "scenegraph/motion.h"

namespace simvis {
namespace {

constexpr std::string_view kAttachedWorld = "ROOT";

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
    .notes = "Needs the bodies before it. They keep the pose to each other that they have when attached becomes 1, "
             "wherever they stand, and do not collide with each other until attached becomes 0. Neither changes their "
             "poses, nor the momentum of both together; a difference of their speeds goes at once. What another element "
             "or a client puts elsewhere meanwhile is drawn back at no more than 1 m/s.",
    .attributes = kAttachmentRows,
    .create = create_element<AttachmentElement>,
});

std::optional<WorldLink> world_link_at(std::span<DynamicObject* const> objects, const std::string& point) {
  const std::optional<StandingBody> body = find_body(objects, point);
  return body ? std::optional(WorldLink{*body->object->id, body->link}) : std::nullopt;
}

}  // namespace

void Attachments::add(Attachment& attachment) {
  attachments_.insert(std::ranges::upper_bound(attachments_, attachment.name, {}, &Attachment::name), &attachment);
}

void Attachments::remove(Attachment& attachment) {
  if (attachment.held) released_.push_back(attachment.held->constraint);
  std::erase(attachments_, &attachment);
}

const Attachment* Attachments::find(const std::string& a, const std::string& b) const {
  const auto found = std::ranges::find_if(attachments_, [&](const Attachment* each) {
    return (each->a == a && each->b == b) || (each->a == b && each->b == a);
  });
  return found == attachments_.end() ? nullptr : *found;
}

void Attachments::restart() {
  for (Attachment* const each : attachments_) each->held.reset();
  released_.clear();
}

void Attachments::act(DynamicsWorld& world, std::span<DynamicObject* const> objects) {
  for (const std::size_t constraint : std::exchange(released_, {})) world.remove_constraint(constraint);
  for (Attachment* const each : attachments_) {
    const std::optional<WorldLink> a = world_link_at(objects, each->a), b = world_link_at(objects, each->b);
    const bool can_hold = a && (b || each->b == kAttachedWorld);
    const WorldLink other = b.value_or(WorldLink());
    const bool is_same = can_hold && each->held && each->held->a == *a && each->held->b == other;
    if (each->held && !(is_same && each->is_wanted)) {
      world.remove_constraint(each->held->constraint);
      each->held.reset();
    }
    if (each->held || !can_hold || !each->is_wanted) continue;
    ConstraintDesc desc{.kind = ConstraintDesc::Kind::fixed, .a = *a, .b = b, .collide = false};
    if (b) desc.a_from_joint = rigid_inverse(world.state(*a).world_from_body) * world.state(*b).world_from_body;
    each->held = Attachment::Held{world.add_constraint(desc), *a, other};
  }
}

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
  if (const Attachment* const other = dynamic_->attachments().find(attachment_.a, attachment_.b)) {
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
