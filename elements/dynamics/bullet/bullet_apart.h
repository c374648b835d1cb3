// Pairs of links that do not collide with each other.
#pragma once

#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>

#include <algorithm>
#include <set>
#include <utility>

#include "elements/dynamics/world/world.h"

class btCollisionObject;

namespace simvis {

/// Bullet asks it for each pair whose boxes begin to overlap, once there are such pairs of links.
class BulletApart : public btOverlapFilterCallback {
 public:
  void add(const WorldLink& a, const WorldLink& b) { pairs_.insert(std::minmax(a, b)); }
  void remove(std::size_t id);
  bool needBroadphaseCollision(btBroadphaseProxy* a, btBroadphaseProxy* b) const override;

 private:
  std::set<std::pair<WorldLink, WorldLink>> pairs_;
};

/// The body or link that has a collision object.
WorldLink world_link_of(const btCollisionObject& object);

}  // namespace simvis
