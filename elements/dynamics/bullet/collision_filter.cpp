#include "elements/dynamics/bullet/collision_filter.h"

#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <vector>

namespace simvis {
namespace {

std::vector<WorldPart> parts_of(const btCollisionObject& object) {
  const auto part_of = [&](const btCollisionShape& shape) {
    return WorldPart{static_cast<std::size_t>(object.getUserIndex()), shape.getUserIndex()};
  };
  const btCollisionShape& shape = *object.getCollisionShape();
  if (!shape.isCompound()) return {part_of(shape)};
  std::vector<WorldPart> parts;
  const auto& compound = static_cast<const btCompoundShape&>(shape);
  parts.reserve(static_cast<std::size_t>(compound.getNumChildShapes()));
  for (int i = 0; i < compound.getNumChildShapes(); ++i) parts.push_back(part_of(*compound.getChildShape(i)));
  return parts;
}

}  // namespace

WorldLink world_link_of(const btCollisionObject& object) {
  const btMultiBodyLinkCollider* const link = btMultiBodyLinkCollider::upcast(&object);
  return {static_cast<std::size_t>(object.getUserIndex()), link == nullptr ? -1 : link->m_link};
}

CollisionMask mask_of(const btCollisionObject& object) {
  return {static_cast<std::uint32_t>(object.getUserIndex2()), static_cast<std::uint32_t>(object.getUserIndex3())};
}

void set_mask(btCollisionObject& object, const CollisionMask& mask) {
  object.setUserIndex2(static_cast<int>(mask.category));
  object.setUserIndex3(static_cast<int>(mask.collides));
}

void CollisionFilter::remove(std::size_t id) {
  std::erase_if(apart_, [&](const auto& pair) { return pair.first.id == id || pair.second.id == id; });
}

void CollisionFilter::release(const WorldLink& a, const WorldLink& b) {
  const auto found = held_.find(std::minmax(a, b));
  if (found != held_.end()) held_.erase(found);
}

bool CollisionFilter::needBroadphaseCollision(btBroadphaseProxy* a, btBroadphaseProxy* b) const {
  const bool may = (a->m_collisionFilterGroup & b->m_collisionFilterMask) != 0 &&
                   (b->m_collisionFilterGroup & a->m_collisionFilterMask) != 0;
  if (!may) return false;
  const btCollisionObject &one = *static_cast<const btCollisionObject*>(a->m_clientObject),
                          &other = *static_cast<const btCollisionObject*>(b->m_clientObject);
  if (!mask_of(one).meets(mask_of(other))) return false;
  if (apart_.empty()) return true;
  const std::vector<WorldPart> others = parts_of(other);
  return std::ranges::any_of(parts_of(one), [&](const WorldPart& part) {
    return std::ranges::any_of(others, [&](const WorldPart& each) { return !are_apart(part, each); });
  });
}

}  // namespace simvis
