#include "engine/geometry/bvh.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <vector>

#include "engine/base/thread_pool.h"

namespace simvis {

namespace {

constexpr int kBins = 16;
// The cost of visiting a node, relative to the cost of testing one primitive.
constexpr double kNodeCost = 1;

constexpr Box kNothing{glm::vec3(std::numeric_limits<float>::max()), glm::vec3(-std::numeric_limits<float>::max())};

Box joined(const Box& a, const Box& b) { return {glm::min(a.low, b.low), glm::max(a.high, b.high)}; }

// In double, because boxes may be 10^18 m wide.
double half_area(const Box& box) {
  const glm::dvec3 size = glm::dvec3(box.high) - glm::dvec3(box.low);
  return size.x * size.y + size.y * size.z + size.z * size.x;
}

Box box_of(const BvhNode& node) { return {node.low, node.high}; }

struct Split {
  double cost = std::numeric_limits<double>::infinity();
  int axis = 0, bin = 0;  // primitives up to this bin go to the first child
};

/// A primitive during the build. Primitives are ordered together with their boxes, so that memory is read sequentially.
struct Primitive {
  Box box;
  std::uint32_t number = 0;

  glm::dvec3 middle() const { return 0.5 * (glm::dvec3(box.low) + glm::dvec3(box.high)); }
};

/// Assigns the middles of boxes to bins.
struct Bins {
  glm::dvec3 low{0}, per_m{0};

  Bins(const glm::dvec3& from, const glm::dvec3& to) : low(from) {
    for (int axis = 0; axis < 3; ++axis) per_m[axis] = to[axis] > from[axis] ? kBins / (to[axis] - from[axis]) : 0;
  }
  int of(const glm::dvec3& middle, int axis) const {
    return std::clamp(static_cast<int>((middle[axis] - low[axis]) * per_m[axis]), 0, kBins - 1);
  }
};

// Returns the cheapest border between two bins. The cost is in areas times tests of primitives.
Split best_split(std::span<const Primitive> primitives, const Bins& bins, std::uint32_t at_once) {
  const auto looks = [at_once](std::uint32_t count) { return (count + at_once - 1) / at_once; };
  struct Content {
    Box box = kNothing;
    std::uint32_t count = 0;
  };
  Content content[3][kBins];
  for (const Primitive& primitive : primitives) {
    const glm::dvec3 middle = primitive.middle();
    for (int axis = 0; axis < 3; ++axis) {
      Content& bin = content[axis][bins.of(middle, axis)];
      bin.box = joined(bin.box, primitive.box);
      ++bin.count;
    }
  }
  Split best;
  for (int axis = 0; axis < 3; ++axis) {
    if (bins.per_m[axis] == 0) continue;
    double after[kBins];  // the cost of the primitives after each bin
    Content rest;
    double cost_after = std::numeric_limits<double>::infinity();
    for (int bin = kBins - 1; bin > 0; --bin) {
      if (content[axis][bin].count > 0) {
        rest.box = joined(rest.box, content[axis][bin].box);
        rest.count += content[axis][bin].count;
        cost_after = looks(rest.count) * half_area(rest.box);
      }
      after[bin - 1] = cost_after;
    }
    rest = {};
    for (int bin = 0; bin + 1 < kBins; ++bin) {
      if (content[axis][bin].count == 0) continue;  // the border before it costs the same
      rest.box = joined(rest.box, content[axis][bin].box);
      rest.count += content[axis][bin].count;
      const double cost = looks(rest.count) * half_area(rest.box) + after[bin];
      if (cost < best.cost) best = {cost, axis, bin};
    }
  }
  return best;
}

/// Orders the primitives as the leaves hold them. The nodes of a subtree begin with its root.
class Builder {
 public:
  Builder(std::vector<Primitive>& primitives, std::uint32_t max_leaf_size, std::uint32_t at_once, ThreadPool* pool)
      : primitives_(primitives), max_leaf_size_(max_leaf_size), at_once_(at_once), pool_(pool) {}

  std::vector<BvhNode> build(std::uint32_t first, std::uint32_t count, std::uint32_t depth) {
    std::vector<BvhNode> nodes(1);
    build(nodes, 0, first, count, depth);
    return nodes;
  }

 private:
  void build(std::vector<BvhNode>& nodes, std::uint32_t node, std::uint32_t first, std::uint32_t count,
             std::uint32_t depth);
  std::uint32_t divide(std::span<Primitive> primitives, std::uint32_t depth, double area);

  std::vector<Primitive>& primitives_;
  std::uint32_t max_leaf_size_, at_once_;
  ThreadPool* pool_;  // null: only the calling thread
};

// Orders a node's primitives by child. Returns how many belong to the first child; 0 for a leaf.
std::uint32_t Builder::divide(std::span<Primitive> primitives, std::uint32_t depth, double area) {
  const auto count = static_cast<std::uint32_t>(primitives.size());
  if (count == 1) return 0;
  glm::dvec3 low(std::numeric_limits<double>::max()), high = -low;
  for (const Primitive& primitive : primitives) {
    low = glm::min(low, primitive.middle());
    high = glm::max(high, primitive.middle());
  }
  const Bins bins(low, high);
  const Split split = best_split(primitives, bins, at_once_);
  const std::uint32_t looks = (count + at_once_ - 1) / at_once_;
  if (count <= max_leaf_size_ && !(split.cost + kNodeCost * area < looks * area)) return 0;
  if (split.cost < std::numeric_limits<double>::infinity()) {
    const auto border = std::partition(primitives.begin(), primitives.end(), [&](const Primitive& primitive) {
      return bins.of(primitive.middle(), split.axis) <= split.bin;
    });
    const auto left = static_cast<std::uint32_t>(border - primitives.begin());
    // Halving from here on must still end within kMaxDepth.
    const auto halvings = static_cast<std::uint32_t>(std::bit_width(std::max(left, count - left) - 1));
    if (depth + 1 + halvings <= Bvh::kMaxDepth) return left;
  }
  const glm::dvec3 size = high - low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::ranges::nth_element(primitives, primitives.begin() + count / 2, [&](const Primitive& a, const Primitive& b) {
    const double at = a.middle()[axis], bt = b.middle()[axis];
    return at < bt || (at == bt && a.number < b.number);
  });
  return count / 2;
}

// Copies a subtree: its root to `node`, its other nodes to the end of `nodes`.
void graft(std::vector<BvhNode>& nodes, std::uint32_t node, std::span<const BvhNode> subtree) {
  const auto offset = static_cast<std::uint32_t>(nodes.size()) - 1;
  const auto moved = [offset](BvhNode n) {
    if (n.count == 0) n.first += offset;
    return n;
  };
  nodes[node] = moved(subtree[0]);
  for (const BvhNode& n : subtree.subspan(1)) nodes.push_back(moved(n));
}

void Builder::build(std::vector<BvhNode>& nodes, std::uint32_t node, std::uint32_t first, std::uint32_t count,
                    std::uint32_t depth) {
  Box box = kNothing;
  const std::span<Primitive> primitives = std::span(primitives_).subspan(first, count);
  for (const Primitive& primitive : primitives) box = joined(box, primitive.box);
  nodes[node] = {box.low, first, box.high, count};
  const std::uint32_t left = divide(primitives, depth, half_area(box));
  if (left == 0) return;
  const auto children = static_cast<std::uint32_t>(nodes.size());
  nodes[node].first = children;
  nodes[node].count = 0;
  nodes.resize(children + 2);
  constexpr std::uint32_t kFew = 50'000;  // waking a thread costs less than dividing a thousand primitives
  if (pool_ == nullptr || pool_->size() == 1 || count < kFew) {
    build(nodes, children, first, left, depth + 1);
    build(nodes, children + 1, first + left, count - left, depth + 1);
    return;
  }
  std::vector<BvhNode> before, after;
  pool_->parallel_both([&] { before = build(first, left, depth + 1); },
                       [&] { after = build(first + left, count - left, depth + 1); });
  graft(nodes, children, before);
  graft(nodes, children + 1, after);
}

}  // namespace

Bvh build_bvh(std::span<const Box> boxes, std::uint32_t max_leaf_size, std::uint32_t at_once, ThreadPool* pool) {
  Bvh bvh;
  if (boxes.empty()) return bvh;
  const auto count = static_cast<std::uint32_t>(boxes.size());
  std::vector<Primitive> primitives(count);
  for (std::uint32_t i = 0; i < count; ++i) primitives[i] = {boxes[i], i};
  bvh.nodes = Builder(primitives, max_leaf_size, at_once, pool).build(0, count, 0);
  bvh.order.reserve(count);
  for (const Primitive& primitive : primitives) bvh.order.push_back(primitive.number);
  return bvh;
}

std::vector<std::uint32_t> refit(Bvh& bvh, std::span<const Box> boxes) {
  std::vector<std::uint32_t> changed;
  for (std::size_t i = bvh.nodes.size(); i-- > 0;) {
    BvhNode& node = bvh.nodes[i];
    Box box = kNothing;
    for (std::uint32_t k = 0; k < node.count; ++k) box = joined(box, boxes[bvh.order[node.first + k]]);
    if (node.count == 0) box = joined(box_of(bvh.nodes[node.first]), box_of(bvh.nodes[node.first + 1]));
    if (box == box_of(node)) continue;
    node.low = box.low;
    node.high = box.high;
    changed.push_back(static_cast<std::uint32_t>(i));
  }
  std::ranges::reverse(changed);
  return changed;
}

double sah_cost(const Bvh& bvh) {
  if (bvh.nodes.empty()) return 0;
  double sum = 0;
  for (const BvhNode& node : bvh.nodes) sum += half_area(box_of(node));
  const double root = half_area(box_of(bvh.nodes[0]));
  return root > 0 ? sum / root : 0;
}

}  // namespace simvis
