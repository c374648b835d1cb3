#include "engine/geometry/tree_cache.h"

#include <algorithm>
#include <cstdint>
#include <optional>

#include "engine/base/assert.h"

namespace simvis {
namespace {

// The version of the file format below and of the trees that WideBvh builds.
constexpr char kTreeVersion = '1';

// A file holds the topology of the tree and no boxes. For each node it holds the number of children, and for each child
// its number and, in the highest bits, the number of primitives that it holds as a leaf. The primitives of each leaf
// follow.
constexpr std::uint32_t kPrimitivesShift = 29, kMaxNumber = (1u << kPrimitivesShift) - 1;
constexpr std::uint32_t kPrimitivesOfLeaf = std::tuple_size_v<WideBvh::Leaf>;
static_assert(kPrimitivesOfLeaf < 1u << (32 - kPrimitivesShift));

std::vector<std::uint32_t> words_of(const WideBvh& tree, const std::vector<WideBvh::Leaf>& leaves) {
  std::vector<std::uint32_t> words{static_cast<std::uint32_t>(tree.nodes().size()),
                                   static_cast<std::uint32_t>(leaves.size())};
  for (const WideNode& node : tree.nodes()) {
    words.push_back(node.children);
    for (std::uint32_t lane = 0; lane < node.children; ++lane) {
      SIMVIS_ASSERT(node.child[lane] <= kMaxNumber);
      words.push_back(node.child[lane] | std::uint32_t{node.primitives[lane]} << kPrimitivesShift);
    }
  }
  for (const WideBvh::Leaf& leaf : leaves) words.insert(words.end(), leaf.begin(), leaf.end());
  return words;
}

/// Builds a tree from the words of a file and checks every word.
class TreeReader {
 public:
  TreeReader(std::span<const std::uint32_t> words, std::span<const Box> boxes) : words_(words), boxes_(boxes) {}

  std::optional<WideBvh> read(std::vector<WideBvh::Leaf>& leaves) {
    const std::uint32_t node_count = next(), leaf_count = next();
    if (node_count == 0 || node_count > words_.size() || leaf_count > words_.size()) return {};
    nodes_.resize(node_count);
    depth_.assign(node_count, 0);
    primitives_.assign(leaf_count, 0);
    for (std::uint32_t i = 0; i < node_count; ++i) {
      if (!read_node(i)) return {};
    }
    if (!read_leaves(leaves)) return {};
    fit(leaves);
    return WideBvh(std::move(nodes_));
  }

 private:
  // Returns the next word. After the last word it returns 0, which is valid nowhere.
  std::uint32_t next() { return at_ < words_.size() ? words_[at_++] : 0; }

  // Every node except the root has occurred exactly once as a child before.
  bool read_node(std::uint32_t index) {
    WideNode& node = nodes_[index];
    node.children = next();
    if (node.children == 0 || node.children > WideNode::kMax || (index > 0 && depth_[index] == 0)) return false;
    for (std::uint32_t lane = 0; lane < node.children; ++lane) {
      const std::uint32_t word = next(), primitives = word >> kPrimitivesShift, number = word & kMaxNumber;
      node.child[lane] = number;
      node.primitives[lane] = static_cast<std::uint8_t>(primitives);
      if (primitives > 0) {
        if (primitives > kPrimitivesOfLeaf || number >= primitives_.size() || primitives_[number] > 0) return false;
        primitives_[number] = node.primitives[lane];
        continue;
      }
      if (number <= index || number >= nodes_.size() || depth_[number] > 0) return false;
      depth_[number] = depth_[index] + 1;
      if (depth_[number] > Bvh::kMaxDepth) return false;
      nodes_[number].parent = index;
      nodes_[number].place = lane;
    }
    return true;
  }

  bool read_leaves(std::vector<WideBvh::Leaf>& leaves) {
    const std::size_t left = words_.size() - at_;
    if (left != primitives_.size() * kPrimitivesOfLeaf) return false;
    leaves.resize(primitives_.size());
    std::vector<bool> seen(boxes_.size());
    std::size_t held = 0;
    for (std::size_t i = 0; i < leaves.size(); ++i) {
      for (std::uint32_t k = 0; k < kPrimitivesOfLeaf; ++k) {
        const std::uint32_t primitive = words_[at_++];
        if (k >= primitives_[i] ? k == 0 || primitive != leaves[i][k - 1]
                                : primitive >= boxes_.size() || seen[primitive])
          return false;
        if (k < primitives_[i]) {
          seen[primitive] = true;
          ++held;
        }
        leaves[i][k] = primitive;
      }
    }
    return held == boxes_.size();
  }

  // The descendants of a node come after it.
  void fit(const std::vector<WideBvh::Leaf>& leaves) {
    for (std::size_t i = nodes_.size(); i-- > 0;) {
      WideNode& node = nodes_[i];
      Box box;
      for (std::uint32_t lane = 0; lane < WideNode::kMax; ++lane) {
        if (lane < node.children) box = box_below(node, lane, leaves);
        node.set_box(lane, box);
      }
    }
  }

  Box box_below(const WideNode& node, std::uint32_t lane, const std::vector<WideBvh::Leaf>& leaves) const {
    if (node.primitives[lane] == 0) return nodes_[node.child[lane]].box_around();
    Box box = boxes_[leaves[node.child[lane]][0]];
    for (const std::uint32_t primitive : leaves[node.child[lane]]) {
      box = {glm::min(box.low, boxes_[primitive].low), glm::max(box.high, boxes_[primitive].high)};
    }
    return box;
  }

  std::span<const std::uint32_t> words_;
  std::span<const Box> boxes_;
  std::size_t at_ = 0;
  std::vector<WideNode> nodes_;
  std::vector<std::uint32_t> depth_;      // by node; 0: not yet a child
  std::vector<std::uint8_t> primitives_;  // by leaf; 0: not yet a child
};

}  // namespace

std::optional<WideBvh> read_cached_tree(std::span<const std::uint32_t> words, std::span<const Box> boxes,
                                        std::vector<WideBvh::Leaf>& leaves) {
  return TreeReader(words, boxes).read(leaves);
}

WideBvh make_tree_cached(const Mesh& mesh, std::span<const Box> boxes, std::vector<WideBvh::Leaf>& leaves,
                         const std::filesystem::path& folder, ThreadPool* pool) {
  if (folder.empty() || boxes.size() < kMinCachedTriangles) return WideBvh(boxes, leaves, pool);
  const MeshCacheFile file(folder, "tree", kTreeVersion, mesh);
  const std::vector<std::uint32_t> words = file.read();
  if (std::optional<WideBvh> kept = read_cached_tree(words, boxes, leaves)) return std::move(*kept);
  WideBvh tree(boxes, leaves, pool);
  file.write(words_of(tree, leaves));
  return tree;
}

}  // namespace simvis
