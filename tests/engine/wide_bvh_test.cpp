// Trees with up to eight children per node: their content, their boxes, and the effect of moves.
#include "engine/geometry/wide_bvh.h"

#include <doctest/doctest.h>

#include <random>
#include <vector>

#include "tests/support/tree_check.h"

TEST_SUITE_BEGIN("engine");

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

std::vector<std::uint32_t> itself(std::uint32_t leaf) { return {leaf}; }

}  // namespace

TEST_CASE("leaves of up to four primitives hold each primitive once, in the smallest boxes") {
  std::mt19937 random(3);
  for (const std::size_t count : {1, 2, 4, 5, 33, 1000}) {
    CAPTURE(count);
    const std::vector<Box> boxes = scattered_boxes(random, count);
    std::vector<WideBvh::Leaf> leaves;
    const WideBvh tree(boxes, leaves);
    check_tree(tree, boxes, leaves);
    // A leaf costs as much as one primitive, so few leaves should be less than half full.
    CHECK(leaves.size() <= count / 2 + 1);
  }
}

TEST_CASE("a tree with movable primitives keeps the smallest boxes after moves") {
  std::mt19937 random(4);
  for (const std::size_t count : {1, 7, 500}) {
    CAPTURE(count);
    std::vector<Box> boxes = scattered_boxes(random, count);
    WideBvh tree(boxes);
    check_tree(tree, boxes, itself);
    for (int round = 0; round < 5; ++round) {
      const std::vector<Box> others = scattered_boxes(random, count);
      for (std::uint32_t primitive = 0; primitive < count; primitive += 3) {
        boxes[primitive] = others[primitive];
        tree.move(primitive, boxes[primitive]);
      }
      check_tree(tree, boxes, itself);
    }
    CHECK(tree.sah_cost() > 0);
  }
}

TEST_CASE("a tree without primitives is empty") {
  std::vector<WideBvh::Leaf> leaves(3);
  CHECK(WideBvh(std::vector<Box>{}, leaves).nodes().empty());
  CHECK(leaves.empty());
  CHECK(WideBvh(std::vector<Box>{}).nodes().empty());
}

TEST_SUITE_END();
