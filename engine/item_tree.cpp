#include "engine/item_tree.h"

namespace simvis {

namespace {

constexpr double kWorstVisits = 2;  // of those when the tree was built

}  // namespace

bool ItemTree::update(RayItems& items) {
  changed_.clear();
  if (!made_ || items.restructured()) {
    boxes_.clear();
    for (const PlacedItem& item : items.items()) boxes_.push_back(item.box);
    build(items);
    return true;
  }
  if (items.moved().empty()) return false;
  for (const std::uint32_t i : items.moved()) boxes_[i] = items.items()[i].box;
  changed_ = refit(bvh_, boxes_);
  ++items.counters.item_trees_refitted;
  if (expected_visits(bvh_) <= kWorstVisits * visits_when_built_) return false;
  build(items);
  return true;
}

void ItemTree::build(RayItems& items) {
  made_ = false;  // until it is whole
  bvh_ = build_bvh(boxes_, 1);
  visits_when_built_ = expected_visits(bvh_);
  ++items.counters.item_trees_built;
  made_ = true;
}

void ItemTree::clear() {
  bvh_ = {};
  made_ = false;
}

}  // namespace simvis
