#include "elements/dynamics/attachments.h"

#include <algorithm>
#include <utility>

#include "scenegraph/motion.h"

namespace simvis {
namespace {

// The two that an attachment holds; empty: one has gone, both are one, or no force moves either.
std::optional<Attachment::Bodies> find_bodies(std::span<DynamicObject* const> objects, const Attachment& attachment) {
  const std::optional<StandingBody> a = find_body(objects, attachment.a);
  const std::optional<StandingBody> b =
      attachment.b == kAttachedWorld ? StandingBody() : find_body(objects, attachment.b);
  if (!a || !b || !(a->is_moved() || b->is_moved())) return std::nullopt;
  if (a->object == b->object && a->link == b->link) return std::nullopt;
  Attachment::Bodies bodies{{*a->object->id, a->link}, std::nullopt};
  if (b->object != nullptr) bodies.b = WorldLink{*b->object->id, b->link};
  return bodies;
}

}  // namespace

void Attachments::add(Attachment& attachment) {
  attachments_.insert(std::ranges::upper_bound(attachments_, attachment.name, {}, &Attachment::name), &attachment);
  is_found_ = false;
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
  is_found_ = false;
}

void Attachments::act(DynamicsWorld& world, std::span<DynamicObject* const> objects) {
  for (const std::size_t constraint : std::exchange(released_, {})) world.remove_constraint(constraint);
  const bool was_found = std::exchange(is_found_, true);
  for (Attachment* const each : attachments_) {
    if (!was_found) each->bodies = find_bodies(objects, *each);
    if (each->held && !(each->is_wanted && each->bodies == each->held->bodies)) {
      world.remove_constraint(each->held->constraint);
      each->held.reset();
    }
    if (each->held || !each->bodies || !each->is_wanted) continue;
    const auto& [a, b] = *each->bodies;
    ConstraintDesc desc{.kind = ConstraintDesc::Kind::fixed, .a = a, .b = b, .collide = false};
    if (b) desc.a_from_joint = rigid_inverse(world.state(a).world_from_body) * world.state(*b).world_from_body;
    each->held = Attachment::Held{world.add_constraint(desc), *each->bodies};
  }
}

}  // namespace simvis
