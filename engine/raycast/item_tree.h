// The host's tree over the items that rays can hit.
#pragma once

#include "engine/geometry/wide_bvh.h"
#include "engine/raycast/ray_instances.h"

namespace simvis {

/// Moved items are refitted into the tree. The tree stays correct, but its traversal becomes slower; beyond
/// kMaxSahCostRatio it is built again.
class ItemTree {
 public:
  enum class Change { none, fitted, built };

  /// Must follow each items.update(). Builds on items.threads().
  Change update(const RayInstances& items);

  /// Tree over RayInstances::items().
  const WideBvh& tree() const { return tree_; }

 private:
  void build(const RayInstances& items);

  WideBvh tree_;
  double sah_cost_when_built_ = 0;
  std::size_t fitted_ = 0;  // items refitted since the last cost check, which costs as much as to refit all
  bool made_ = false;
};

}  // namespace simvis
