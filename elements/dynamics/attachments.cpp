#include "elements/dynamics/attachments.h"

#include <algorithm>
#include <utility>

#include "scenegraph/motion.h"

namespace simvis {
namespace {

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

}  // namespace simvis
