// The tree over the items that rays can meet, on the host.
#pragma once

#include "engine/geometry/wide_bvh.h"
#include "engine/raycast/ray_instances.h"

namespace simvis {

/// Items that move are fitted into the tree, which then holds, and gets slower to walk: see kMaxSahCostRatio.
class ItemTree {
 public:
  enum class Change { none, fitted, built };

  /// After items.update(), each time.
  Change update(const RayInstances& items);

  /// Over RayInstances::items().
  const WideBvh& tree() const { return tree_; }

 private:
  void build(const RayInstances& items);

  WideBvh tree_;
  double sah_cost_when_built_ = 0;
  std::size_t fitted_ = 0;  // items, since that was last looked at: to look costs as much as to fit all
  bool made_ = false;
};

}  // namespace simvis
