// What the caches of trees and of orders hold, read for one small mesh: nothing is built for an input.
#include <cstring>
#include <vector>

#include "engine/base/assert.h"
#include "engine/geometry/cluster_cache.h"
#include "engine/geometry/tree_cache.h"
#include "tests/fuzz/fuzz_target.h"

namespace simvis::fuzz {
namespace {

constexpr std::uint32_t kTriangles = 24;

std::vector<std::uint32_t> words_in(Input input) {
  std::vector<std::uint32_t> words(input.size() / sizeof(std::uint32_t));
  if (!words.empty()) std::memcpy(words.data(), input.data(), words.size() * sizeof(std::uint32_t));
  return words;
}

/// Triangles in a row, apart from each other.
Mesh row_of_triangles() {
  Mesh mesh;
  for (std::uint32_t i = 0; i < kTriangles; ++i) {
    const float x = 2 * static_cast<float>(i);
    mesh.positions.insert(mesh.positions.end(), {{x, 0, 0}, {x + 1, 0, 0}, {x, 1, 0}});
    mesh.indices.insert(mesh.indices.end(), {3 * i, 3 * i + 1, 3 * i + 2});
  }
  mesh.attributes.resize(mesh.positions.size());
  return mesh;
}

bool holds(const Box& outer, const Box& inner) {
  return glm::all(glm::lessThanEqual(outer.low, inner.low)) && glm::all(glm::lessThanEqual(inner.high, outer.high));
}

/// Counts the triangles below a node, each of which must lie in the box of its child.
void count_below(const WideBvh& tree, const std::vector<WideBvh::Leaf>& leaves, const std::vector<Box>& boxes,
                 std::vector<int>& seen) {
  for (const WideNode& node : tree.nodes()) {
    SIMVIS_ASSERT(node.children >= 1 && node.children <= WideNode::kMax);
    for (std::uint32_t lane = 0; lane < node.children; ++lane) {
      if (node.primitives[lane] == 0) {
        SIMVIS_ASSERT(holds(node.box(lane), tree.nodes()[node.child[lane]].box_around()));
        continue;
      }
      for (std::uint32_t k = 0; k < node.primitives[lane]; ++k) {
        const std::uint32_t triangle = leaves[node.child[lane]][k];
        ++seen[triangle];
        SIMVIS_ASSERT(holds(node.box(lane), boxes[triangle]));
      }
    }
  }
}

void read_tree(Input input) {
  static const std::vector<Box> boxes = [] {
    std::vector<Box> all;
    const Mesh mesh = row_of_triangles();
    for (std::size_t i = 0; i < mesh.positions.size(); i += 3) {
      all.push_back({mesh.positions[i], {mesh.positions[i].x + 1, 1, 0}});
    }
    return all;
  }();
  std::vector<WideBvh::Leaf> leaves;
  const std::optional<WideBvh> tree = read_cached_tree(words_in(input), boxes, leaves);
  if (!tree) return;
  std::vector<int> seen(kTriangles);
  count_below(*tree, leaves, boxes, seen);
  for (const int times : seen) SIMVIS_ASSERT(times == 1);
}

void read_order(Input input) {
  static const Mesh mesh = row_of_triangles();
  const std::vector<std::uint32_t> order = words_in(input);
  if (is_order_of(order, kTriangles)) clusters_in_order(mesh, order);
}

const TargetRegistration kTree("tree", read_tree);
const TargetRegistration kOrder("order", read_order);

}  // namespace
}  // namespace simvis::fuzz
