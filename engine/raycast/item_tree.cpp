#include "engine/raycast/item_tree.h"

#include <vector>

namespace simvis {

ItemTree::Change ItemTree::update(const RayItems& items) {
  if (made_ && !items.restructured()) {
    if (items.moved().empty()) return Change::none;
    made_ = false;  // until it is whole
    for (const std::uint32_t i : items.moved()) tree_.move(i, items.items()[i].box);
    fitted_ += items.moved().size();
    const bool looks = fitted_ >= items.items().size();
    if (looks) fitted_ = 0;
    made_ = !looks || tree_.expected_visits() <= kWorstVisits * visits_when_built_;
    if (made_) return Change::fitted;
  }
  build(items);
  return Change::built;
}

void ItemTree::build(const RayItems& items) {
  made_ = false;
  std::vector<Box> boxes;
  boxes.reserve(items.items().size());
  for (const PlacedItem& item : items.items()) boxes.push_back(item.box);
  tree_ = WideBvh(boxes, &items.threads());
  visits_when_built_ = tree_.expected_visits();
  fitted_ = 0;
  made_ = true;
}

}  // namespace simvis
