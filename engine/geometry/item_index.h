// Spatial index of a draw list: a tree over its items' boxes, so that a search need not test all items.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include <simvis/draw_list.h>
#include "engine/geometry/bvh.h"
#include "engine/geometry/item_extent.h"
#include "engine/geometry/view_projection.h"

namespace simvis {

/// The index of a list that has a change log: see index_of(). The tree is refitted to items that move. It stays
/// correct, but traversal becomes slower; if the cost exceeds kMaxSahCostRatio times the cost at the build, the tree is
/// rebuilt.
class ItemIndex {
 public:
  const WorldBox& box(std::uint32_t item) const { return boxes_[item]; }
  const ItemExtent& extent(std::uint32_t item) const { return extents_[item]; }
  std::span<const std::uint32_t> standing_at(TransformRange entries) const { return standing_[entries]; }

  /// Appends the items whose boxes are not outside the view, in any order. Returns how many boxes were tested.
  std::uint64_t find_seen(const ViewProjection& projection, std::vector<std::uint32_t>& items) const;

  /// The tree over the items; its primitives are numbers of items. Its boxes contain the items' boxes, some with
  /// padding; their coordinates are in the world frame, relative to origin(). An item whose place is not finite has a
  /// box that covers everything.
  const Bvh& tree() const { return tree_; }
  const glm::dvec3& origin() const { return origin_; }
  /// The largest lengths of the items below a node.
  const ItemExtent& longest_below(std::uint32_t node) const { return longest_below_[node]; }

 private:
  friend const ItemIndex* index_of(const DrawList& list);

  void update(const DrawList& list);
  void build(const DrawList& list);
  void build_tree();
  void place(const DrawList& list, std::uint32_t item);
  void fit(std::span<const std::uint32_t> items);
  bool fit_node(std::uint32_t node);

  ListVersion version_;
  StandingAt standing_;
  std::vector<WorldBox> boxes_;
  std::vector<ItemExtent> extents_;
  glm::dvec3 origin_{0};
  std::vector<Box> tree_boxes_;  // by item
  Bvh tree_;
  std::vector<std::uint32_t> parents_;  // by node
  std::vector<std::uint32_t> leaves_;   // by item
  std::vector<ItemExtent> longest_below_;
  double sah_cost_when_built_ = 0;
  std::size_t fitted_ = 0;  // items refitted since the last cost check, which costs as much as refitting all
};

/// Returns the index, up to date with the list. It is valid until the list is written or destroyed. Null if the list
/// has no change log.
const ItemIndex* index_of(const DrawList& list);

}  // namespace simvis
