// A bounding volume hierarchy whose nodes have up to eight children, for one core that tests eight boxes at a time.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "engine/geometry/bvh.h"
#include "engine/geometry/simd.h"

namespace simvis {

/// A node with the boxes of its children. A child is a node or a leaf.
// All compilers align it alike; for machines without vectors of 32 bytes GCC aligns those of simd.h to 16 bytes.
struct alignas(32) WideNode {
  static constexpr unsigned kMax = 8;

  Float8 low[3], high[3];              ///< by axis; a lane without a child holds any box
  std::uint32_t child[kMax] = {};      ///< the number of a node, or of a leaf
  std::uint8_t primitives[kMax] = {};  ///< number of a leaf's primitives; 0: the child is a node
  std::uint32_t children = 0;
  std::uint32_t parent = 0, place = 0;  ///< this node is lane `place` of `parent`; the root has 0 and 0

  void set_box(std::uint32_t lane, const Box& box);
  Box box(std::uint32_t lane) const;
  Box box_around() const;  ///< the box around all children
};

/// Empty if there are no primitives; else nodes[0] is the root.
class WideBvh {
 public:
  /// The primitives of a leaf, which are tested together; the last one is repeated if there are fewer.
  using Leaf = std::array<std::uint32_t, 4>;

  WideBvh() = default;
  /// Builds a tree over finite boxes. The same boxes give the same tree. `pool` as for build_bvh(). Every primitive is
  /// a leaf that has the primitive's number, and can be moved.
  explicit WideBvh(std::span<const Box> boxes, ThreadPool* pool = nullptr);

  /// The same with up to four primitives in a leaf, none of which can be moved. leaves[i] holds the primitives of leaf
  /// i.
  WideBvh(std::span<const Box> boxes, std::vector<Leaf>& leaves, ThreadPool* pool = nullptr);

  /// A tree of existing nodes, whose primitives cannot be moved.
  explicit WideBvh(std::vector<WideNode> nodes) : nodes_(std::move(nodes)) {}

  const std::vector<WideNode>& nodes() const { return nodes_; }

  /// Changes the box of a primitive. The tree stays correct, but traversal becomes slower if primitives have moved far.
  void move(std::uint32_t primitive, const Box& box);

  /// The expected number of boxes hit by a random ray that hits the root's box, from their surface areas.
  double sah_cost() const;

 private:
  struct Place {
    std::uint32_t node = 0, lane = 0;
  };

  std::vector<WideNode> nodes_;
  std::vector<Place> places_;  // of the primitives that can be moved
};

}  // namespace simvis
