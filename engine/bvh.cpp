#include "engine/bvh.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>

namespace simvis {

namespace {

constexpr int kBins = 16;
// What it costs to look into a node, where to look at one thing costs 1.
constexpr double kNodeCost = 1;

constexpr Box kNothing{glm::vec3(std::numeric_limits<float>::max()), glm::vec3(-std::numeric_limits<float>::max())};

Box joined(const Box& a, const Box& b) { return {glm::min(a.low, b.low), glm::max(a.high, b.high)}; }

// In double: boxes may be 10^18 m wide.
double half_area(const Box& box) {
  const glm::dvec3 size = glm::dvec3(box.high) - glm::dvec3(box.low);
  return size.x * size.y + size.y * size.z + size.z * size.x;
}

Box box_of(const BvhNode& node) { return {node.low, node.high}; }

struct Split {
  double cost = std::numeric_limits<double>::infinity();
  int axis = 0, bin = 0;  // things up to this bin go first
};

class Builder {
 public:
  Builder(std::span<const Box> boxes, std::uint32_t most_in_leaf, Bvh& bvh)
      : boxes_(boxes), most_in_leaf_(most_in_leaf), bvh_(bvh) {}

  void build(std::uint32_t node, std::uint32_t first, std::uint32_t count, std::uint32_t depth);

 private:
  glm::dvec3 middle(std::uint32_t thing) const {
    return 0.5 * (glm::dvec3(boxes_[thing].low) + glm::dvec3(boxes_[thing].high));
  }
  std::span<std::uint32_t> things(std::uint32_t first, std::uint32_t count) {
    return std::span(bvh_.order).subspan(first, count);
  }
  int bin_of(std::uint32_t thing, int axis) const {
    const double share = (middle(thing)[axis] - low_[axis]) / (high_[axis] - low_[axis]);
    return std::clamp(static_cast<int>(share * kBins), 0, kBins - 1);
  }
  Split best_split(std::span<const std::uint32_t> things) const;
  std::uint32_t divide(std::uint32_t first, std::uint32_t count, std::uint32_t depth, double area);

  std::span<const Box> boxes_;
  std::uint32_t most_in_leaf_;
  Bvh& bvh_;
  glm::dvec3 low_{0}, high_{0};  // of the middles of the things that are being divided
};

// The cheapest border between two bins. The cost is in areas times things.
Split Builder::best_split(std::span<const std::uint32_t> things) const {
  Split best;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(high_[axis] > low_[axis])) continue;
    Box bins[kBins];
    std::uint32_t counts[kBins] = {};
    std::fill(std::begin(bins), std::end(bins), kNothing);
    for (const std::uint32_t thing : things) {
      const int bin = bin_of(thing, axis);
      bins[bin] = joined(bins[bin], boxes_[thing]);
      ++counts[bin];
    }
    double after[kBins];  // the cost of what lies behind each bin
    Box box = kNothing;
    std::uint32_t count = 0;
    for (int bin = kBins - 1; bin > 0; --bin) {
      box = joined(box, bins[bin]);
      count += counts[bin];
      after[bin - 1] = count == 0 ? std::numeric_limits<double>::infinity() : count * half_area(box);
    }
    box = kNothing;
    count = 0;
    for (int bin = 0; bin + 1 < kBins; ++bin) {
      box = joined(box, bins[bin]);
      count += counts[bin];
      if (count == 0) continue;
      const double cost = count * half_area(box) + after[bin];
      if (cost < best.cost) best = {cost, axis, bin};
    }
  }
  return best;
}

// Puts a node's things into the order of its children; returns how many go to the first, 0 for a leaf.
std::uint32_t Builder::divide(std::uint32_t first, std::uint32_t count, std::uint32_t depth, double area) {
  if (count == 1) return 0;
  const std::span<std::uint32_t> things = this->things(first, count);
  const Split split = best_split(things);
  if (count <= most_in_leaf_ && !(split.cost + kNodeCost * area < count * area)) return 0;
  if (split.cost < std::numeric_limits<double>::infinity()) {
    const auto border = std::partition(things.begin(), things.end(),
                                       [&](std::uint32_t thing) { return bin_of(thing, split.axis) <= split.bin; });
    const auto left = static_cast<std::uint32_t>(border - things.begin());
    // Dividing by halves from here on must still end above the deepest level.
    const auto halvings = static_cast<std::uint32_t>(std::bit_width(std::max(left, count - left) - 1));
    if (depth + 1 + halvings <= Bvh::kMaxDepth) return left;
  }
  const glm::dvec3 size = high_ - low_;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::ranges::nth_element(things, things.begin() + count / 2, [&](std::uint32_t a, std::uint32_t b) {
    const double at = middle(a)[axis], bt = middle(b)[axis];
    return at < bt || (at == bt && a < b);
  });
  return count / 2;
}

void Builder::build(std::uint32_t node, std::uint32_t first, std::uint32_t count, std::uint32_t depth) {
  Box box = kNothing;
  low_ = glm::dvec3(std::numeric_limits<double>::max());
  high_ = -low_;
  for (const std::uint32_t thing : things(first, count)) {
    box = joined(box, boxes_[thing]);
    low_ = glm::min(low_, middle(thing));
    high_ = glm::max(high_, middle(thing));
  }
  bvh_.nodes[node] = {box.low, first, box.high, count};
  const std::uint32_t left = divide(first, count, depth, half_area(box));
  if (left == 0) return;
  const auto children = static_cast<std::uint32_t>(bvh_.nodes.size());
  bvh_.nodes[node].first = children;
  bvh_.nodes[node].count = 0;
  bvh_.nodes.resize(children + 2);
  build(children, first, left, depth + 1);
  build(children + 1, first + left, count - left, depth + 1);
}

}  // namespace

Bvh build_bvh(std::span<const Box> boxes, std::uint32_t most_in_leaf) {
  Bvh bvh;
  if (boxes.empty()) return bvh;
  bvh.order.resize(boxes.size());
  std::iota(bvh.order.begin(), bvh.order.end(), 0u);
  bvh.nodes.resize(1);
  Builder(boxes, most_in_leaf, bvh).build(0, 0, static_cast<std::uint32_t>(boxes.size()), 0);
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

double expected_visits(const Bvh& bvh) {
  if (bvh.nodes.empty()) return 0;
  double sum = 0;
  for (const BvhNode& node : bvh.nodes) sum += half_area(box_of(node));
  const double root = half_area(box_of(bvh.nodes[0]));
  return root > 0 ? sum / root : 0;
}

}  // namespace simvis
