// Trees whose nodes have up to eight children: what they hold, by whose boxes, and what moving a thing leaves of that.
#include "engine/wide_bvh.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <functional>
#include <random>
#include <vector>

using namespace simvis;

namespace {

std::vector<Box> scattered_boxes(std::mt19937& random, std::size_t count) {
  std::uniform_real_distribution<float> unit(-1, 1);
  std::vector<Box> boxes;
  while (boxes.size() < count) {
    const glm::vec3 low(unit(random), unit(random), unit(random));
    boxes.push_back({low, low + 0.1f * glm::abs(glm::vec3(unit(random), unit(random), unit(random)))});
  }
  return boxes;
}

Box box_of(const WideNode& node, std::uint32_t lane) {
  return {{node.low[0][lane], node.low[1][lane], node.low[2][lane]},
          {node.high[0][lane], node.high[1][lane], node.high[2][lane]}};
}

Box around(const Box& a, const Box& b) { return {glm::min(a.low, b.low), glm::max(a.high, b.high)}; }

/// `things_of` says what a leaf of a number holds. Every thing is in one leaf; each child's box is the smallest around
/// the things below.
void check_tree(const WideBvh& tree, const std::vector<Box>& boxes,
                const std::function<std::vector<std::uint32_t>(std::uint32_t leaf)>& things_of) {
  std::vector<int> seen(boxes.size());
  std::size_t nodes = 0;
  const std::function<Box(std::uint32_t)> visit = [&](std::uint32_t index) {
    const WideNode& node = tree.nodes()[index];
    ++nodes;
    REQUIRE(node.children >= 1);
    REQUIRE(node.children <= WideNode::kMost);
    Box all = box_of(node, 0);
    for (std::uint32_t lane = 0; lane < node.children; ++lane) {
      Box below;
      if (node.things[lane] == 0) {
        REQUIRE(node.child[lane] > index);
        REQUIRE(tree.nodes()[node.child[lane]].parent == index);
        REQUIRE(tree.nodes()[node.child[lane]].place == lane);
        below = visit(node.child[lane]);
      } else {
        const std::vector<std::uint32_t> things = things_of(node.child[lane]);
        REQUIRE(things.size() >= node.things[lane]);
        below = boxes[things[0]];
        for (std::uint32_t k = 0; k < node.things[lane]; ++k) {
          ++seen[things[k]];
          below = around(below, boxes[things[k]]);
        }
        for (std::size_t k = node.things[lane]; k < things.size(); ++k) REQUIRE(things[k] == things[k - 1]);
      }
      REQUIRE(below == box_of(node, lane));
      all = around(all, below);
    }
    return all;
  };
  visit(0);
  CHECK(nodes == tree.nodes().size());
  CHECK(std::ranges::all_of(seen, [](int times) { return times == 1; }));
}

std::vector<std::uint32_t> itself(std::uint32_t leaf) { return {leaf}; }

}  // namespace

TEST_CASE("leaves of up to four things hold each thing once, in the smallest boxes") {
  std::mt19937 random(3);
  for (const std::size_t count : {1, 2, 4, 5, 33, 1000}) {
    CAPTURE(count);
    const std::vector<Box> boxes = scattered_boxes(random, count);
    std::vector<WideBvh::Leaf> leaves;
    const WideBvh tree(boxes, leaves);
    check_tree(tree, boxes, [&](std::uint32_t leaf) {
      return std::vector<std::uint32_t>(leaves.at(leaf).begin(), leaves.at(leaf).end());
    });
    // A leaf costs as much as one thing, so there is no reason for many that hold less than half.
    CHECK(leaves.size() <= count / 2 + 1);
  }
}

TEST_CASE("a tree whose things can be moved holds them in the smallest boxes wherever they go") {
  std::mt19937 random(4);
  for (const std::size_t count : {1, 7, 500}) {
    CAPTURE(count);
    std::vector<Box> boxes = scattered_boxes(random, count);
    WideBvh tree(boxes);
    check_tree(tree, boxes, itself);
    for (int round = 0; round < 5; ++round) {
      const std::vector<Box> others = scattered_boxes(random, count);
      for (std::uint32_t thing = 0; thing < count; thing += 3) {
        boxes[thing] = others[thing];
        tree.move(thing, boxes[thing]);
      }
      check_tree(tree, boxes, itself);
    }
    CHECK(tree.expected_visits() > 0);
  }
}

TEST_CASE("a tree over nothing is empty") {
  std::vector<WideBvh::Leaf> leaves(3);
  CHECK(WideBvh(std::vector<Box>{}, leaves).nodes().empty());
  CHECK(leaves.empty());
  CHECK(WideBvh(std::vector<Box>{}).nodes().empty());
}
