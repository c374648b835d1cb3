// A tree of boxes whose nodes have up to eight children, for one core that looks at eight boxes at a time.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "engine/geometry/bvh.h"
#include "engine/geometry/simd.h"

namespace simvis {

/// The boxes of the children stand here. A child is a node, or a leaf.
struct WideNode {
  static constexpr unsigned kMax = 8;

  Float8 low[3], high[3];              ///< by axes; a lane without a child holds some box
  std::uint32_t child[kMax] = {};      ///< the number of a node, or of a leaf
  std::uint8_t primitives[kMax] = {};  ///< of a leaf; 0: a node
  std::uint32_t children = 0;
  std::uint32_t parent = 0, place = 0;  ///< where this stands: lane `place` of `parent`. Of the root itself, lane 0

  void set_box(std::uint32_t lane, const Box& box);
  Box box(std::uint32_t lane) const;
  Box box_around() const;  ///< all children
};

/// Empty where there is nothing; else nodes[0] is the root.
class WideBvh {
 public:
  /// Things of a leaf that are looked at together; where there are fewer, the last stands there again.
  using Leaf = std::array<std::uint32_t, 4>;

  WideBvh() = default;
  /// Boxes are finite. The same boxes give the same tree. Every thing is a leaf of its own, of its own number, and can
  /// be moved.
  explicit WideBvh(std::span<const Box> boxes);

  /// The same with up to four things in a leaf; leaf i's are leaves[i].
  WideBvh(std::span<const Box> boxes, std::vector<Leaf>& leaves);

  /// Of such nodes, of which nothing can be moved.
  explicit WideBvh(std::vector<WideNode> nodes) : nodes_(std::move(nodes)) {}

  const std::vector<WideNode>& nodes() const { return nodes_; }

  /// The tree stays right, and gets slower where things have moved far.
  void move(std::uint32_t primitive, const Box& box);

  /// How many boxes a random ray meets that meets the root's, by their surface areas.
  double sah_cost() const;

 private:
  struct Place {
    std::uint32_t node = 0, lane = 0;
  };

  std::vector<WideNode> nodes_;
  std::vector<Place> places_;  // of things that can be moved
};

}  // namespace simvis
