#include "engine/raycast/item_tree.h"

#include <vector>

namespace simvis {

ItemTree::Change ItemTree::update(const RayInstances& items) {
  if (made_ && !items.structure_changed()) {
    if (items.moved_items().empty()) return Change::none;
    made_ = false;  // until all moved items are refitted
    for (const std::uint32_t i : items.moved_items()) tree_.move(i, items.items()[i].box);
    fitted_ += items.moved_items().size();
    const bool looks = fitted_ >= items.items().size();
    if (looks) fitted_ = 0;
    made_ = !looks || tree_.sah_cost() <= kMaxSahCostRatio * sah_cost_when_built_;
    if (made_) return Change::fitted;
  }
  build(items);
  return Change::built;
}

void ItemTree::build(const RayInstances& items) {
  made_ = false;
  std::vector<Box> boxes;
  boxes.reserve(items.items().size());
  for (const RayInstance& item : items.items()) boxes.push_back(item.box);
  tree_ = WideBvh(boxes, &items.threads());
  sah_cost_when_built_ = tree_.sah_cost();
  fitted_ = 0;
  made_ = true;
}

}  // namespace simvis
