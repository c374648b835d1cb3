// Walks a ray through a Bvh in double.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/bvh.h"

namespace simvis {

/// A ray in the frame of a Bvh: its points are from + t * way, t >= 0.
struct BvhRay {
  glm::dvec3 from{0}, way{0};
};

/// Where the ray enters the box grown by `padding` on every side, before `end`; infinity where it does not.
inline double enter_box(const BvhRay& ray, const glm::dvec3& low, const glm::dvec3& high, double padding, double end) {
  double first = 0, last = end;
  for (int axis = 0; axis < 3; ++axis) {
    const double below = low[axis] - padding - ray.from[axis], above = high[axis] + padding - ray.from[axis];
    if (ray.way[axis] == 0) {
      if (below > 0 || above < 0) return std::numeric_limits<double>::infinity();
      continue;
    }
    const double s = below / ray.way[axis], t = above / ray.way[axis];
    first = std::max(first, std::min(s, t));
    last = std::min(last, std::max(s, t));
  }
  return first <= last ? first : std::numeric_limits<double>::infinity();
}

/// Calls `visit` with each thing whose leaf's box, grown by `padding`, the ray meets before `end()`, nearer ones first
/// as far as boxes tell. `end` is asked anew at each step: what was visited may have brought it nearer.
template <typename End, typename Visit>
void walk_bvh(const Bvh& bvh, const BvhRay& ray, double padding, End&& end, Visit&& visit) {
  if (bvh.nodes.empty()) return;
  struct Waiting {
    std::uint32_t node;
    double start;
  };
  const auto enter = [&](std::uint32_t node) {
    const BvhNode& n = bvh.nodes[node];
    return enter_box(ray, glm::dvec3(n.low), glm::dvec3(n.high), padding, end());
  };
  constexpr double kNever = std::numeric_limits<double>::infinity();
  std::array<Waiting, Bvh::kMaxDepth + 1> stack;
  std::size_t waiting = 0;
  const auto wait = [&](std::uint32_t node, double start) {
    if (start < kNever) stack[waiting++] = {node, start};
  };
  wait(0, enter(0));
  while (waiting > 0) {
    const Waiting next = stack[--waiting];
    if (next.start > end()) continue;
    const BvhNode& node = bvh.nodes[next.node];
    if (node.count > 0) {
      for (std::uint32_t k = 0; k < node.count; ++k) visit(bvh.order[node.first + k]);
      continue;
    }
    const double left = enter(node.first), right = enter(node.first + 1);
    const std::uint32_t farther = left <= right ? 1 : 0;
    wait(node.first + farther, std::max(left, right));
    wait(node.first + 1 - farther, std::min(left, right));
  }
}

}  // namespace simvis
