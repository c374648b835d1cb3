// A bounding volume hierarchy over primitives that have boxes: plain data, built and refitted on the host.
//
// It is built from the top, by the surface-area heuristic over bins: Wald, "On fast Construction of SAH-based Bounding
// Volume Hierarchies", IEEE Symposium on Interactive Ray Tracing, 2007.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace simvis {

class ThreadPool;

struct Box {
  glm::vec3 low{0}, high{0};

  bool operator==(const Box&) const = default;
};

/// The two children of an inner node are adjacent and come after their parent. A leaf holds primitives of Bvh::order.
struct BvhNode {
  glm::vec3 low{0};
  std::uint32_t first = 0;  ///< inner: index of the first of two children; leaf: an index into Bvh::order
  glm::vec3 high{0};
  std::uint32_t count = 0;  ///< number of a leaf's primitives; 0: an inner node

  bool operator==(const BvhNode&) const = default;
};

/// Empty if there are no primitives; else nodes[0] is the root.
struct Bvh {
  /// The largest number of steps from the root to a leaf, for any boxes; the tree can hold up to 2^32 primitives.
  static constexpr std::uint32_t kMaxDepth = 32;

  std::vector<BvhNode> nodes;
  std::vector<std::uint32_t> order;  ///< numbers of the primitives, in the order of the leaves
};

/// Builds a tree over finite boxes. The same boxes give the same tree. The cost model assumes that testing up to
/// `at_once` primitives of a leaf costs as much as testing one. `pool` has the threads of the build, null for the
/// calling thread alone; the tree does not depend on it.
Bvh build_bvh(std::span<const Box> boxes, std::uint32_t max_leaf_size, std::uint32_t at_once = 1,
              ThreadPool* pool = nullptr);

/// Fits the tree to boxes that have changed. The tree stays correct, but traversal becomes slower if primitives have
/// moved far. Returns the changed nodes in ascending order.
std::vector<std::uint32_t> refit(Bvh& bvh, std::span<const Box> boxes);

/// The expected number of boxes hit by a random ray that hits the root's box, from their surface areas. 0 for an empty
/// tree.
double sah_cost(const Bvh& bvh);

}  // namespace simvis
