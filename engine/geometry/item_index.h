// Where the items of a draw list are: a tree over their boxes, so that who looks for some of them need not look at all.
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

/// Of a list whose writer keeps account: see index_of(). Items that move are fitted into the tree, which then holds,
/// and gets slower to walk; where that is by more than kMaxSahCostRatio, it is built anew.
class ItemIndex {
 public:
  const WorldBox& box(std::uint32_t item) const { return boxes_[item]; }
  const ItemExtent& extent(std::uint32_t item) const { return extents_[item]; }
  std::span<const std::uint32_t> standing_at(TransformRange entries) const { return standing_[entries]; }

  /// Adds the items whose boxes are not outside the view, in any order; returns how many boxes that took to look at.
  std::uint64_t find_seen(const ViewProjection& projection, std::vector<std::uint32_t>& items) const;

  /// Boxes hold those of the items whole, some with room to spare; their coordinates are the world's, less origin().
  /// Things are items. Where a place is not finite, the box is that of everything.
  const Bvh& tree() const { return tree_; }
  const glm::dvec3& origin() const { return origin_; }
  /// Of the items below a node.
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
  std::size_t fitted_ = 0;  // items, since the tree was last looked at: to look costs as much as to fit all
};

/// Up to date with the list, and valid until that is written or gone. Null where nobody keeps account of the list.
const ItemIndex* index_of(const DrawList& list);

}  // namespace simvis
