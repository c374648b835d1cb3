// Which shapes collide: masks, and pairs of parts that stay apart.
#pragma once

#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>

#include <algorithm>
#include <set>
#include <utility>

#include "elements/dynamics/world/world.h"

class btCollisionObject;

namespace simvis {

/// Bullet asks it for each pair of objects whose boxes begin to overlap, once the world has such a pair or mask. Two
/// objects of which some shapes collide are a pair; their shapes are compared one by one where contacts are found.
class CollisionFilter : public btOverlapFilterCallback {
 public:
  void keep_apart(const WorldPart& a, const WorldPart& b) { apart_.insert(std::minmax(a, b)); }
  void remove(std::size_t id);
  /// Two bodies or links that are attached to each other do not collide until the last attachment is released. Their
  /// pair stays, because Bullet looks for pairs only where something moves.
  void hold(const WorldLink& a, const WorldLink& b) { held_.insert(std::minmax(a, b)); }
  void release(const WorldLink& a, const WorldLink& b);
  bool are_held(const WorldLink& a, const WorldLink& b) const {
    return !held_.empty() && held_.contains(std::minmax(a, b));
  }
  bool are_apart(const WorldPart& a, const WorldPart& b) const {
    return !apart_.empty() && apart_.contains(std::minmax(a, b));
  }
  bool needBroadphaseCollision(btBroadphaseProxy* a, btBroadphaseProxy* b) const override;

 private:
  std::set<std::pair<WorldPart, WorldPart>> apart_;
  std::multiset<std::pair<WorldLink, WorldLink>> held_;
};

/// The body or link that has a collision object.
WorldLink world_link_of(const btCollisionObject& object);

/// The bits that any shape of an object has, as set_mask() gave them.
CollisionMask mask_of(const btCollisionObject& object);
void set_mask(btCollisionObject& object, const CollisionMask& mask);

}  // namespace simvis
