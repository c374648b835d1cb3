// A bundle of rays on its way through a tree of boxes, in float32. Part of bundle_walk.cpp.
#pragma once

#include <array>
#include <bit>
#include <cstring>
#include <limits>

#include "engine/ray_bundle.h"
#include "engine/wide_bvh.h"

namespace simvis {

SIMVIS_INLINE Float8 all8(float value) { return Float8{value, value, value, value, value, value, value, value}; }

/// The planes of a bundle in the frame of a tree, for boxes: what of a box lies farthest inwards of a plane is inwards
/// by d + the normal . the corner that lies farthest along it. Float32 rounds that by less than `slack`: 15 half ulps
/// for what it is made of and for itself, and sums of up to sqrt(2) times how far the tree's points lie from the
/// sensor.
struct TreePlanes {
  Float8 normal[3];  // by axes; lanes are planes
  Float8 d;
  int corner[3][8];  // 1 where the farthest corner's coordinate is the high one
  float slack = 0;
  double scale = 1;  // of lengths, from metres
  float end = 0;     // what lies farther away along the last plane's normal, turned round, is behind all nearest hits

  SIMVIS_INLINE void end_at(double range_m) { end = static_cast<float>(range_m * scale * (1 + 0x1p-22)) + slack; }
};

/// `linear` and `centre`: scaled point in the sensor frame = linear * p + centre.
SIMVIS_INLINE TreePlanes planes_in(const RayBundle& bundle, const glm::mat3& linear, const glm::vec3& centre,
                                   double scale, float slack) {
  TreePlanes planes;
  planes.scale = scale;
  planes.slack = slack;
  const auto along = [&](const glm::vec3& v) __attribute__((always_inline)) {
    return bundle.normal_x * all8(v.x) + bundle.normal_y * all8(v.y) + bundle.normal_z * all8(v.z);
  };
  for (int axis = 0; axis < 3; ++axis) {
    planes.normal[axis] = along(linear[axis]);
    const auto corners = -(planes.normal[axis] > all8(0));
    std::memcpy(planes.corner[axis], &corners, sizeof corners);
  }
  planes.d = along(centre);
  return planes;
}

/// Which children of the node the bundle may meet, bit by bit; how far away the nearest point of each child's box is,
/// scaled.
SIMVIS_INLINE unsigned reached(const TreePlanes& planes, const WideNode& node, Float8& distance) {
  const Float8* const corners[3][2] = {
      {&node.low[0], &node.high[0]}, {&node.low[1], &node.high[1]}, {&node.low[2], &node.high[2]}};
  const auto inwards = [&](int plane) __attribute__((always_inline)) {
    return all8(planes.d[plane]) + all8(planes.normal[0][plane]) * *corners[0][planes.corner[0][plane]] +
           all8(planes.normal[1][plane]) * *corners[1][planes.corner[1][plane]] +
           all8(planes.normal[2][plane]) * *corners[2][planes.corner[2][plane]];
  };
  constexpr int kDistance = RayBundle::kPlanes - 1;
  distance = -inwards(kDistance);
  Mask8 beyond = distance > all8(planes.end);
  for (int plane = 0; plane < kDistance; ++plane) beyond |= inwards(plane) < all8(-planes.slack);
  return ~bits_of(beyond) & ((1u << node.children) - 1);
}

inline constexpr std::uint32_t kLastNode = 0x7fffffff;  // above are things: see WideNode
inline constexpr float kFarthestBox = std::numeric_limits<float>::max();

/// Has memory begin to bring what is needed soon.
SIMVIS_INLINE void fetch(const WideNode& node) {
  for (int axis = 0; axis < 3; axis += 2) {
    __builtin_prefetch(&node.low[axis]);
    __builtin_prefetch(&node.high[axis]);
  }
}

struct WaitingBox {
  std::uint32_t node;
  float distance;
};

/// Calls `visit` with each thing that may be met, nearer ones first as far as boxes tell. `visit` may bring the planes'
/// end nearer.
template <typename Visit>
SIMVIS_INLINE void walk_tree(const WideBvh& tree, const TreePlanes& planes, const Visit& visit) {
  if (tree.nodes().empty()) return;
  std::array<WaitingBox, Bvh::kMaxDepth * WideNode::kMost> stack;
  std::size_t waiting = 1;
  stack[0] = {0, -kFarthestBox};
  while (waiting > 0) {
    const WaitingBox next = stack[--waiting];
    if (next.distance > planes.end) continue;
    if (next.node > kLastNode) {
      visit(~next.node);
      continue;
    }
    const WideNode& node = tree.nodes()[next.node];
    Float8 distance;
    const std::size_t below = waiting;
    for (unsigned left = reached(planes, node, distance); left != 0; left &= left - 1) {
      const auto lane = static_cast<unsigned>(std::countr_zero(left));
      const WaitingBox child{node.child[lane], distance[lane]};
      std::size_t at = waiting++;
      for (; at > below && stack[at - 1].distance < child.distance; --at) stack[at] = stack[at - 1];
      stack[at] = child;
      if (child.node <= kLastNode) fetch(tree.nodes()[child.node]);
    }
  }
}

}  // namespace simvis
