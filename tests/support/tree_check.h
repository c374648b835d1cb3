// Checks trees with up to eight children per node.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <vector>

#include "engine/geometry/wide_bvh.h"

namespace simvis {

/// `things_of` says what a leaf of a number holds. Every thing is in one leaf; each child's box is the smallest around
/// the things below.
inline void check_tree(const WideBvh& tree, const std::vector<Box>& boxes,
                       const std::function<std::vector<std::uint32_t>(std::uint32_t leaf)>& things_of) {
  std::vector<int> seen(boxes.size());
  std::size_t nodes = 0;
  const std::function<Box(std::uint32_t)> visit = [&](std::uint32_t index) {
    const WideNode& node = tree.nodes()[index];
    ++nodes;
    REQUIRE(node.children >= 1);
    REQUIRE(node.children <= WideNode::kMax);
    Box all = node.box(0);
    for (std::uint32_t lane = 0; lane < node.children; ++lane) {
      Box below;
      if (node.primitives[lane] == 0) {
        REQUIRE(node.child[lane] > index);
        REQUIRE(tree.nodes()[node.child[lane]].parent == index);
        REQUIRE(tree.nodes()[node.child[lane]].place == lane);
        below = visit(node.child[lane]);
      } else {
        const std::vector<std::uint32_t> primitives = things_of(node.child[lane]);
        REQUIRE(primitives.size() >= node.primitives[lane]);
        below = boxes[primitives[0]];
        for (std::uint32_t k = 0; k < node.primitives[lane]; ++k) {
          ++seen[primitives[k]];
          below = {glm::min(below.low, boxes[primitives[k]].low), glm::max(below.high, boxes[primitives[k]].high)};
        }
        for (std::size_t k = node.primitives[lane]; k < primitives.size(); ++k)
          REQUIRE(primitives[k] == primitives[k - 1]);
      }
      REQUIRE(below == node.box(lane));
      all = {glm::min(all.low, below.low), glm::max(all.high, below.high)};
    }
    return all;
  };
  visit(0);
  CHECK(nodes == tree.nodes().size());
  CHECK(std::ranges::all_of(seen, [](int times) { return times == 1; }));
}

inline void check_tree(const WideBvh& tree, const std::vector<Box>& boxes, const std::vector<WideBvh::Leaf>& leaves) {
  check_tree(tree, boxes, [&](std::uint32_t leaf) {
    return std::vector<std::uint32_t>(leaves.at(leaf).begin(), leaves.at(leaf).end());
  });
}

}  // namespace simvis
