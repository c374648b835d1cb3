#include "elements/dynamics/attachments.h"

#include <algorithm>
#include <utility>

#include "scenegraph/motion.h"

namespace simvis {
namespace {

// The world has no link.
WorldLink link_of(const StandingBody& body) {
  return body.object == nullptr ? WorldLink() : WorldLink{*body.object->id, body.link};
}

// The two that an attachment holds as they stand now; empty: one has gone, both are one, or no force moves either.
std::optional<std::pair<StandingBody, StandingBody>> held_bodies(std::span<DynamicObject* const> objects,
                                                                 const Attachment& attachment) {
  const std::optional<StandingBody> a = find_body(objects, attachment.a);
  const std::optional<StandingBody> b =
      attachment.b == kAttachedWorld ? StandingBody() : find_body(objects, attachment.b);
  if (!a || !b || !(a->is_moved() || b->is_moved())) return std::nullopt;
  if (a->object == b->object && a->link == b->link) return std::nullopt;
  return std::pair(*a, *b);
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
    const std::optional<std::pair<StandingBody, StandingBody>> bodies = held_bodies(objects, *each);
    const WorldLink a = bodies ? link_of(bodies->first) : WorldLink(), b = bodies ? link_of(bodies->second) : a;
    const bool is_same = bodies && each->held && each->held->a == a && each->held->b == b;
    if (each->held && !(is_same && each->is_wanted)) {
      world.remove_constraint(each->held->constraint);
      each->held.reset();
    }
    if (each->held || !bodies || !each->is_wanted) continue;
    ConstraintDesc desc{.kind = ConstraintDesc::Kind::fixed, .a = a, .collide = false};
    if (bodies->second.object != nullptr) {
      desc.b = b;
      desc.a_from_joint = rigid_inverse(world.state(a).world_from_body) * world.state(b).world_from_body;
    }
    each->held = Attachment::Held{world.add_constraint(desc), a, b};
  }
}

void Attachments::archive(StateArchive& state) {
  for (Attachment* const each : attachments_) state(each->held);
  state(released_);
}

}  // namespace simvis
