// Trees of boxes: their content, their depth, and the effect of refitting.
#include "engine/geometry/bvh.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

TEST_SUITE_BEGIN("engine");

using namespace simvis;

namespace {

std::vector<Box> random_boxes(std::uint32_t seed, std::size_t count, float size) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-1, 1);
  std::vector<Box> boxes;
  while (boxes.size() < count) {
    const glm::vec3 low(unit(random), unit(random), unit(random));
    boxes.push_back({low, low + size * glm::abs(glm::vec3(unit(random), unit(random), unit(random)))});
  }
  return boxes;
}

/// Every primitive is in one leaf. The box of a node is the smallest around its content. Leaves and depth are within
/// limits.
void check_tree(const Bvh& bvh, const std::vector<Box>& boxes, std::uint32_t max_leaf_size) {
  std::vector<int> seen(boxes.size());
  std::size_t nodes = 0;
  const std::function<Box(std::uint32_t, std::uint32_t)> visit = [&](std::uint32_t i, std::uint32_t depth) {
    const BvhNode& node = bvh.nodes[i];
    ++nodes;
    REQUIRE(depth <= Bvh::kMaxDepth);
    REQUIRE(node.count <= max_leaf_size);
    Box box;
    if (node.count == 0) {
      REQUIRE(node.first > i);
      const Box left = visit(node.first, depth + 1), right = visit(node.first + 1, depth + 1);
      box = {glm::min(left.low, right.low), glm::max(left.high, right.high)};
    } else {
      box = boxes[bvh.order[node.first]];
      for (std::uint32_t k = 0; k < node.count; ++k) {
        const std::uint32_t primitive = bvh.order[node.first + k];
        ++seen[primitive];
        box = {glm::min(box.low, boxes[primitive].low), glm::max(box.high, boxes[primitive].high)};
      }
    }
    REQUIRE(box == Box{node.low, node.high});
    return box;
  };
  visit(0, 0);
  CHECK(nodes == bvh.nodes.size());
  CHECK(std::ranges::all_of(seen, [](int times) { return times == 1; }));
}

}  // namespace

TEST_CASE("trees hold each primitive once, in the smallest boxes") {
  CHECK(build_bvh({}, 4).nodes.empty());
  for (const std::uint32_t max_leaf_size : {1u, 4u}) {
    for (const std::size_t count : {1, 2, 3, 5, 100, 3000}) {
      const std::vector<Box> boxes = random_boxes(static_cast<std::uint32_t>(count), count, 0.1f);
      const Bvh bvh = build_bvh(boxes, max_leaf_size);
      check_tree(bvh, boxes, max_leaf_size);
      CHECK(bvh.nodes == build_bvh(boxes, max_leaf_size).nodes);
    }
  }
}

TEST_CASE("no arrangement makes a tree too deep") {
  std::vector<Box> same(1000, Box{glm::vec3(1), glm::vec3(2)});
  check_tree(build_bvh(same, 1), same, 1);
  // Each half is as far from the origin as the one before, so a split by bins separates only a few of them.
  std::vector<Box> halving;
  for (int i = 0; i < 140; ++i) {
    const glm::vec3 place(std::ldexp(1.0f, -i), 0, 0);
    for (int copy = 0; copy < 50; ++copy) halving.push_back({place, place});
  }
  check_tree(build_bvh(halving, 1), halving, 1);
  constexpr float kHuge = std::numeric_limits<float>::max();
  std::vector<Box> huge = random_boxes(3, 500, 0.1f);
  for (std::size_t i = 0; i < huge.size(); i += 7) huge[i] = {glm::vec3(-kHuge), glm::vec3(kHuge)};
  check_tree(build_bvh(huge, 1), huge, 1);
}

TEST_CASE("a tree over clusters costs a fraction of one over unordered primitives") {
  std::vector<Box> boxes;
  for (std::uint32_t cluster = 0; cluster < 64; ++cluster) {
    for (Box box : random_boxes(cluster, 64, 0.1f)) {
      const glm::vec3 place(100.0f * (cluster % 4), 100.0f * (cluster / 4 % 4), 100.0f * (cluster / 16));
      boxes.push_back({box.low + place, box.high + place});
    }
  }
  Bvh bvh = build_bvh(boxes, 1);
  // The boxes of the clusters are 2 m wide in a world of 300 m. A ray visits few nodes besides the 2 * 64 nodes above
  // them, whose areas at least halve with each level.
  CHECK(sah_cost(bvh) < 64);
  std::mt19937 random(1);
  std::ranges::shuffle(boxes, random);
  refit(bvh, boxes);
  CHECK(sah_cost(bvh) > 1000);  // nearly every node is as large as the world
}

TEST_CASE("refitting keeps the tree correct and reports the changed nodes") {
  std::vector<Box> boxes = random_boxes(5, 1000, 0.05f);
  Bvh bvh = build_bvh(boxes, 1);
  CHECK(refit(bvh, boxes).empty());
  std::mt19937 random(6);
  for (int move = 0; move < 100; ++move) {
    const Bvh before = bvh;
    boxes[random() % boxes.size()] = random_boxes(random(), 1, 0.05f)[0];
    const std::vector<std::uint32_t> changed = refit(bvh, boxes);
    check_tree(bvh, boxes, 1);
    CHECK(std::ranges::is_sorted(changed));
    CHECK(changed.size() <= Bvh::kMaxDepth + 1);
    for (std::uint32_t i = 0; i < bvh.nodes.size(); ++i) {
      CHECK((bvh.nodes[i] == before.nodes[i]) == !std::ranges::binary_search(changed, i));
    }
  }
}

TEST_SUITE_END();
