#include "engine/geometry/item_index.h"

#include <algorithm>
#include <utility>

#include "engine/base/assert.h"
#include "engine/geometry/box_padding.h"

namespace simvis {

namespace {

// Testing a few boxes costs less than one more node.
constexpr std::uint32_t kMaxLeafSize = 4;
// If more than this share of the items moves at once, all nodes are refitted, instead of each item's path to the root.
constexpr double kMany = 1.0 / 16;

Box tree_box(const WorldBox& box, const glm::dvec3& origin) {
  const glm::dvec3 centre = box.center - origin;
  const glm::dvec3 reach = glm::abs(box.axis[0]) + glm::abs(box.axis[1]) + glm::abs(box.axis[2]);
  const double farthest = glm::length(glm::abs(centre) + reach);
  constexpr auto kFar = static_cast<float>(kFarthest);
  if (!(farthest < kFarthest)) return {glm::vec3(-kFar), glm::vec3(kFar)};
  return padded_box(centre - reach, centre + reach, kPadding * farthest);
}

}  // namespace

const ItemIndex* index_of(const DrawList& list) {
  if (!list.changes.kept()) return nullptr;
  std::shared_ptr<ItemIndex>& index = list.changes.index_;
  if (index == nullptr) index = std::make_shared<ItemIndex>();
  index->update(list);
  return index.get();
}

void ItemIndex::update(const DrawList& list) {
  const ListVersion seen = std::exchange(version_, {});  // empty until the update is complete
  const auto written = list.changes.moved_since(seen);
  const auto changed = list.changes.items_since(seen);
  if (written && changed) {
    std::vector<std::uint32_t> moved(changed->begin(), changed->end());
    for (const TransformRange& entries : *written) {
      const auto items = standing_[entries];
      moved.insert(moved.end(), items.begin(), items.end());
    }
    for (const std::uint32_t item : moved) place(list, item);
    fit(moved);
  } else {
    build(list);
  }
  version_ = list.changes.version();
}

void ItemIndex::build(const DrawList& list) {
  const std::size_t count = list.items.size();
  std::vector<std::uint32_t> transforms;
  transforms.reserve(count);
  for (const DrawItem& item : list.items) {
    SIMVIS_ASSERT(item.mesh < list.meshes.size() && item.transform < list.world_from_node.size());
    transforms.push_back(item.transform);
  }
  standing_ = StandingAt(transforms, list.world_from_node.size());
  boxes_.resize(count);
  extents_.resize(count);
  tree_boxes_.resize(count);
  origin_ = glm::dvec3(0);
  if (count > 0) place(list, 0);
  if (count > 0 && glm::length(boxes_[0].center) < kFarthest) origin_ = boxes_[0].center;
  for (std::uint32_t item = 0; item < count; ++item) place(list, item);
  build_tree();
}

void ItemIndex::place(const DrawList& list, std::uint32_t item) {
  const glm::dmat4& world_from_mesh = list.world_from_node[list.items[item].transform];
  const Mesh& mesh = *list.meshes[list.items[item].mesh];
  const glm::dvec3 low(mesh.bounds_min), high(mesh.bounds_max);
  boxes_[item] = make_box(world_from_mesh, (low + high) * 0.5, (high - low) * 0.5);
  extents_[item] = extent_of(mesh, world_from_mesh);
  tree_boxes_[item] = tree_box(boxes_[item], origin_);
}

void ItemIndex::build_tree() {
  tree_ = build_bvh(tree_boxes_, kMaxLeafSize);
  sah_cost_when_built_ = sah_cost(tree_);
  fitted_ = 0;
  parents_.assign(tree_.nodes.size(), 0);
  leaves_.resize(boxes_.size());
  longest_below_.assign(tree_.nodes.size(), {});
  for (auto node = static_cast<std::uint32_t>(tree_.nodes.size()); node-- > 0;) {
    const BvhNode& n = tree_.nodes[node];
    if (n.count == 0) parents_[n.first] = parents_[n.first + 1] = node;
    for (std::uint32_t k = 0; k < n.count; ++k) leaves_[tree_.order[n.first + k]] = node;
    fit_node(node);
  }
}

// Fits the node to its children or its items. Returns whether the node has changed.
bool ItemIndex::fit_node(std::uint32_t node) {
  BvhNode& n = tree_.nodes[node];
  Box box;
  ItemExtent longest_of;
  const auto add = [&](bool first, const glm::vec3& low, const glm::vec3& high, const ItemExtent& extent) {
    box = first ? Box{low, high} : Box{glm::min(box.low, low), glm::max(box.high, high)};
    longest_of = longest(longest_of, extent);
  };
  for (std::uint32_t k = 0; k < n.count; ++k) {
    const std::uint32_t item = tree_.order[n.first + k];
    add(k == 0, tree_boxes_[item].low, tree_boxes_[item].high, extents_[item]);
  }
  for (std::uint32_t k = 0; k < 2 && n.count == 0; ++k) {
    const BvhNode& child = tree_.nodes[n.first + k];
    add(k == 0, child.low, child.high, longest_below_[n.first + k]);
  }
  if (box == Box{n.low, n.high} && longest_of == longest_below_[node]) return false;
  n.low = box.low;
  n.high = box.high;
  longest_below_[node] = longest_of;
  return true;
}

void ItemIndex::fit(std::span<const std::uint32_t> items) {
  if (items.size() > kMany * boxes_.size()) {
    for (auto node = static_cast<std::uint32_t>(tree_.nodes.size()); node-- > 0;) fit_node(node);
  } else {
    for (const std::uint32_t item : items) {
      for (std::uint32_t node = leaves_[item]; fit_node(node) && node != 0;) node = parents_[node];
    }
  }
  fitted_ += items.size();
  if (fitted_ == 0 || fitted_ < boxes_.size()) return;
  fitted_ = 0;
  if (sah_cost(tree_) > kMaxSahCostRatio * sah_cost_when_built_) build_tree();
}

std::uint64_t ItemIndex::find_seen(const ViewProjection& projection, std::vector<std::uint32_t>& items) const {
  if (tree_.nodes.empty()) return 0;
  std::uint64_t looked_at = 0;
  // At most one child is waiting for each level below the root.
  std::uint32_t waiting[Bvh::kMaxDepth + 2] = {0};
  for (std::size_t count = 1; count > 0;) {
    const BvhNode& node = tree_.nodes[waiting[--count]];
    const glm::dvec3 low(node.low), high(node.high);
    ++looked_at;
    if (all_outside(projection, origin_ + 0.5 * (low + high), 0.5 * (high - low))) continue;
    if (node.count == 0) {
      waiting[count++] = node.first;
      waiting[count++] = node.first + 1;
      continue;
    }
    looked_at += node.count;
    for (std::uint32_t k = 0; k < node.count; ++k) {
      const std::uint32_t item = tree_.order[node.first + k];
      if (!outside(projection, boxes_[item])) items.push_back(item);
    }
  }
  return looked_at;
}

}  // namespace simvis
