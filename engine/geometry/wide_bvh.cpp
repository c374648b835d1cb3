#include "engine/geometry/wide_bvh.h"

#include <algorithm>

namespace simvis {

void WideNode::set_box(std::uint32_t lane, const Box& box) {
  for (int axis = 0; axis < 3; ++axis) {
    low[axis][lane] = box.low[axis];
    high[axis][lane] = box.high[axis];
  }
}

Box WideNode::box(std::uint32_t lane) const {
  return {{low[0][lane], low[1][lane], low[2][lane]}, {high[0][lane], high[1][lane], high[2][lane]}};
}

Box WideNode::box_around() const {
  Box all = box(0);
  for (std::uint32_t lane = 1; lane < children; ++lane) {
    const Box other = box(lane);
    all = {glm::min(all.low, other.low), glm::max(all.high, other.high)};
  }
  return all;
}

namespace {

double box_half_area(const glm::vec3& low, const glm::vec3& high) {
  const glm::dvec3 size = glm::dvec3(high) - glm::dvec3(low);
  return size.x * size.y + size.y * size.z + size.z * size.x;
}

// The descendants of a binary node that become children of the wide node: the largest inner node is opened repeatedly
// until there are kMax children.
std::vector<std::uint32_t> descendants(const Bvh& bvh, std::uint32_t node) {
  if (bvh.nodes[node].count > 0) return {node};
  std::vector<std::uint32_t> found{bvh.nodes[node].first, bvh.nodes[node].first + 1};
  while (found.size() < WideNode::kMax) {
    std::size_t largest = found.size();
    double most = -1;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const BvhNode& n = bvh.nodes[found[i]];
      if (n.count > 0 || box_half_area(n.low, n.high) <= most) continue;
      most = box_half_area(n.low, n.high);
      largest = i;
    }
    if (largest == found.size()) break;
    const std::uint32_t opened = bvh.nodes[found[largest]].first;
    found[largest] = opened;
    found.insert(found.begin() + static_cast<std::ptrdiff_t>(largest) + 1, opened + 1);
  }
  return found;
}

/// Converts a binary tree to a wide one, from the root on; a node comes before its descendants.
template <typename NumberLeaf>
std::uint32_t add_node(std::vector<WideNode>& nodes, const Bvh& bvh, std::uint32_t binary, std::uint32_t parent,
                       std::uint32_t place, const NumberLeaf& number_leaf) {
  const auto index = static_cast<std::uint32_t>(nodes.size());
  const std::vector<std::uint32_t> children = descendants(bvh, binary);
  WideNode node;
  node.children = static_cast<std::uint32_t>(children.size());
  node.parent = parent;
  node.place = place;
  for (std::uint32_t lane = 0; lane < WideNode::kMax; ++lane) {
    const BvhNode& child = bvh.nodes[children[std::min(lane, node.children - 1)]];
    node.set_box(lane, {child.low, child.high});
  }
  nodes.push_back(node);
  for (std::uint32_t lane = 0; lane < children.size(); ++lane) {
    const BvhNode& child = bvh.nodes[children[lane]];
    const std::uint32_t to = child.count > 0 ? number_leaf(std::span(bvh.order).subspan(child.first, child.count))
                                             : add_node(nodes, bvh, children[lane], index, lane, number_leaf);
    nodes[index].child[lane] = to;
    nodes[index].primitives[lane] = static_cast<std::uint8_t>(child.count);
  }
  return index;
}

}  // namespace

WideBvh::WideBvh(std::span<const Box> boxes, ThreadPool* pool) : places_(boxes.size()) {
  if (boxes.empty()) return;
  add_node(nodes_, build_bvh(boxes, 1, 1, pool), 0, 0, 0,
           [](std::span<const std::uint32_t> primitives) { return primitives[0]; });
  nodes_.shrink_to_fit();
  for (std::uint32_t node = 0; node < nodes_.size(); ++node) {
    for (std::uint32_t lane = 0; lane < nodes_[node].children; ++lane) {
      if (nodes_[node].primitives[lane] > 0) places_[nodes_[node].child[lane]] = {node, lane};
    }
  }
}

WideBvh::WideBvh(std::span<const Box> boxes, std::vector<Leaf>& leaves, ThreadPool* pool) {
  leaves.clear();
  if (boxes.empty()) return;
  constexpr auto kMax = static_cast<std::uint32_t>(std::tuple_size_v<Leaf>);
  add_node(nodes_, build_bvh(boxes, kMax, kMax, pool), 0, 0, 0, [&](std::span<const std::uint32_t> primitives) {
    Leaf& leaf = leaves.emplace_back();
    leaf.fill(primitives.back());
    std::ranges::copy(primitives, leaf.begin());
    return static_cast<std::uint32_t>(leaves.size() - 1);
  });
  nodes_.shrink_to_fit();
  leaves.shrink_to_fit();
}

void WideBvh::move(std::uint32_t primitive, const Box& box) {
  Place at = places_[primitive];
  Box moved = box;
  while (true) {
    WideNode& node = nodes_[at.node];
    if (node.box(at.lane) == moved) return;
    node.set_box(at.lane, moved);
    if (at.node == 0) return;
    moved = node.box_around();
    at = {node.parent, node.place};
  }
}

double WideBvh::sah_cost() const {
  if (nodes_.empty()) return 0;
  double sum = 0;
  for (const WideNode& node : nodes_) {
    for (std::uint32_t lane = 0; lane < node.children; ++lane) {
      const Box box = node.box(lane);
      sum += box_half_area(box.low, box.high);
    }
  }
  const Box all = nodes_[0].box_around();
  const double root = box_half_area(all.low, all.high);
  return root > 0 ? sum / root : 0;
}

}  // namespace simvis
