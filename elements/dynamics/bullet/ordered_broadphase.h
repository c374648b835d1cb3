// Bullet's broadphase, whose trees depend on what was done and not on where their nodes lie in memory.
#pragma once

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>

#include <cstdint>
#include <span>

#include <simvis/state_archive.h>

class btCollisionObject;

namespace simvis {

/// Bullet turns its trees so that parents lie before their children in memory. The order in which pairs are found, and
/// so the order of contacts in the solver, then follows from addresses. This one leaves that out: equal steps give
/// equal bytes, also in a world whose state was restored.
class OrderedBroadphase : public btDbvtBroadphase {
 public:
  void calculateOverlappingPairs(btDispatcher* dispatcher) override;
  /// Removes all pairs, the last one first: Bullet looks through all of them for those of one body.
  void remove_pairs(btDispatcher& dispatcher);
  /// The boxes of objects, and the trees and lists in which they stand. Objects are numbered by their place.
  void archive(StateArchive& state, std::span<btCollisionObject* const> objects);

 private:
  struct TreeNode {
    std::uint32_t number = 0;
    btDbvtVolume box{};
    void archive(StateArchive& state);
  };
  void settle();
  void clean_up(btDispatcher& dispatcher);
  void archive_lists(StateArchive& state, std::span<btDbvtProxy* const> proxies);
  void archive_tree(StateArchive& state, int set, std::span<btDbvtProxy* const> proxies);
  void make_tree(StateArchive& state, int set, std::span<const TreeNode> nodes, std::span<btDbvtProxy* const> proxies);
};

}  // namespace simvis
