#include "elements/dynamics/bullet/bullet_apart.h"

#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

namespace simvis {

WorldLink world_link_of(const btCollisionObject& object) {
  const btMultiBodyLinkCollider* const link = btMultiBodyLinkCollider::upcast(&object);
  return {static_cast<std::size_t>(object.getUserIndex()), link == nullptr ? -1 : link->m_link};
}

void BulletApart::remove(std::size_t id) {
  std::erase_if(pairs_, [&](const auto& pair) { return pair.first.id == id || pair.second.id == id; });
}

bool BulletApart::needBroadphaseCollision(btBroadphaseProxy* a, btBroadphaseProxy* b) const {
  const bool may = (a->m_collisionFilterGroup & b->m_collisionFilterMask) != 0 &&
                   (b->m_collisionFilterGroup & a->m_collisionFilterMask) != 0;
  if (!may) return false;
  const WorldLink link_a = world_link_of(*static_cast<const btCollisionObject*>(a->m_clientObject)),
                  link_b = world_link_of(*static_cast<const btCollisionObject*>(b->m_clientObject));
  return !pairs_.contains(std::minmax(link_a, link_b));
}

}  // namespace simvis
