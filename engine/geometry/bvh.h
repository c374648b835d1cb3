// A tree of boxes over things that have boxes: plain data, built and refitted on the host.
//
// Built from the top, by the surface-area heuristic over bins: Wald, "On fast Construction of SAH-based Bounding Volume
// Hierarchies", IEEE Symposium on Interactive Ray Tracing, 2007.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace simvis {

struct Box {
  glm::vec3 low{0}, high{0};

  bool operator==(const Box&) const = default;
};

/// The children of an inner node stand side by side, after their parent. A leaf holds things of Bvh::order.
struct BvhNode {
  glm::vec3 low{0};
  std::uint32_t first = 0;  ///< inner: the first of two children; leaf: an index of Bvh::order
  glm::vec3 high{0};
  std::uint32_t count = 0;  ///< of a leaf's things; 0: an inner node

  bool operator==(const BvhNode&) const = default;
};

/// Empty where there is nothing; else nodes[0] is the root.
struct Bvh {
  /// From the root to a leaf there are at most so many steps, whatever the boxes: up to 2^32 things fit.
  static constexpr std::uint32_t kMaxDepth = 32;

  std::vector<BvhNode> nodes;
  std::vector<std::uint32_t> order;  ///< the things, as leaves hold them
};

/// Boxes are finite. The same boxes give the same tree. To look at up to `at_once` things of a leaf costs as much as to
/// look at one.
Bvh build_bvh(std::span<const Box> boxes, std::uint32_t max_leaf_size, std::uint32_t at_once = 1);

/// Fits the tree to boxes that have changed: it stays right, and gets slower where things have moved far. Returns the
/// nodes that are other than before, in ascending order.
std::vector<std::uint32_t> refit(Bvh& bvh, std::span<const Box> boxes);

/// How many boxes a random ray meets that meets the root's, by their surface areas. 0 for an empty tree.
double sah_cost(const Bvh& bvh);

}  // namespace simvis
