// The tree over the items that rays can meet.
#pragma once

#include <vector>

#include "engine/ray_items.h"

namespace simvis {

/// Items that move are refitted into the tree, which then holds, and gets slower to walk. It is built anew where there
/// are other items, and where a ray has to look into twice as many boxes as when it was built.
class ItemTree {
 public:
  /// After items.update(). True if the tree is another one; else changed() says what of it is.
  bool update(RayItems& items);

  /// Over RayItems::items(), one in a leaf.
  const Bvh& bvh() const { return bvh_; }

  /// Nodes that the last update() has fitted, in ascending order.
  const std::vector<std::uint32_t>& changed() const { return changed_; }

  /// Forgets everything.
  void clear();

 private:
  void build(RayItems& items);

  Bvh bvh_;
  std::vector<Box> boxes_;
  std::vector<std::uint32_t> changed_;
  double visits_when_built_ = 0;
  bool made_ = false;
};

}  // namespace simvis
