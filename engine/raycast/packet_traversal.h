// Traversal of a tree of boxes by a ray packet, in float32. Part of packet_cast.cpp.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "engine/geometry/wide_bvh.h"
#include "engine/raycast/ray_packet.h"

namespace simvis {

/// The planes of a packet in the frame of a tree, for tests against boxes. The largest value of a plane function in a
/// box is d + normal . c, where c is the corner of the box that is farthest along the normal. The rounding error of
/// this value in float32 is less than `slack`: 15 half ulps, for the inputs and for the expression itself, of sums of
/// up to sqrt(2) times the distance of the tree's points from the sensor.
struct TreePlanes {
  Float8 normal[3];  // indexed by axis; each SIMD lane is a plane
  Float8 d;
  int corner[3][8];  // 1 where the farthest corner has the high coordinate
  float slack = 0;
  double scale = 1;        // factor from metres to lengths in the tree's frame
  float m_per_length = 1;  // metres for each of these lengths, rounded down
  // Boxes farther than this along the negated normal of the last plane are behind all nearest hits.
  float end = 0;

  SIMVIS_INLINE void end_at(double range_m) { end = static_cast<float>(range_m * scale * (1 + 0x1p-22)) + slack; }
};

/// `linear` and `centre`: scaled point in the sensor frame = linear * p + centre.
SIMVIS_INLINE TreePlanes planes_in(const RayPacket& packet, const glm::mat3& linear, const glm::vec3& centre,
                                   double scale, float slack) {
  TreePlanes planes;
  planes.scale = scale;
  planes.slack = slack;
  planes.m_per_length = static_cast<float>((1 - 0x1p-20) / scale);
  const auto along = [&](const glm::vec3& v) __attribute__((always_inline)) {
    return packet.normal_x * splat8(v.x) + packet.normal_y * splat8(v.y) + packet.normal_z * splat8(v.z);
  };
  for (int axis = 0; axis < 3; ++axis) {
    planes.normal[axis] = along(linear[axis]);
    const auto corners = -(planes.normal[axis] > splat8(0));
    std::memcpy(planes.corner[axis], &corners, sizeof corners);
  }
  planes.d = along(centre);
  return planes;
}

/// The children of a node as the packet sees them.
struct SeenChildren {
  unsigned reached;        // bit i: the packet may hit child i
  unsigned whole;          // bit i: the shears rule out no ray of the packet for child i
  Float8 distance;         // distance of the nearest point of each box, scaled
  Float8 depth;            // lower bound of the depth along the packet's z; the shears are known where it is above 0
  Float8 low[2], high[2];  // bounds of the shears along x and y
};

SIMVIS_INLINE SeenChildren see_children(const RayPacket& packet, const TreePlanes& planes, const WideNode& node) {
  const Float8* const corners[3][2] = {
      {&node.low[0], &node.high[0]}, {&node.low[1], &node.high[1]}, {&node.low[2], &node.high[2]}};
  const auto inwards = [&](int plane, int farthest) __attribute__((always_inline)) {
    return splat8(planes.d[plane]) +
           splat8(planes.normal[0][plane]) * *corners[0][planes.corner[0][plane] ^ farthest ^ 1] +
           splat8(planes.normal[1][plane]) * *corners[1][planes.corner[1][plane] ^ farthest ^ 1] +
           splat8(planes.normal[2][plane]) * *corners[2][planes.corner[2][plane] ^ farthest ^ 1];
  };
  constexpr int kAhead = RayPacket::kPlanes - 2, kDistance = RayPacket::kPlanes - 1;
  const Float8 slack = splat8(planes.slack);
  SeenChildren seen;
  seen.distance = -inwards(kDistance, 1);
  seen.depth = inwards(kAhead, 0) - slack;
  Mask8 beyond = (seen.distance > splat8(planes.end)) | (inwards(kAhead, 1) < -slack);
  const Float8 per_depth = splat8(1) / seen.depth;
  Mask8 whole = seen.depth > splat8(0);
  for (int axis = 0; axis < 2; ++axis) {
    // Points of the box lie at most `above` inside the plane x - low z >= 0, so their shear is at most low + above /
    // depth.
    const Float8 above = inwards(2 * axis, 1) + slack, below = inwards(2 * axis + 1, 1) + slack;
    beyond |= (above < splat8(0)) | (below < splat8(0));
    const Float8 low_shear = splat8(packet.low_shear[axis]), high_shear = splat8(packet.high_shear[axis]);
    seen.low[axis] = high_shear - below * per_depth;
    seen.high[axis] = low_shear + above * per_depth;
    whole &= (seen.low[axis] <= low_shear) & (seen.high[axis] >= high_shear);
  }
  seen.whole = bits_of(whole | ~(seen.depth > splat8(0)));
  seen.reached = ~bits_of(beyond) & ((1u << node.children) - 1);
  return seen;
}

inline constexpr std::uint32_t kAllRays = ~std::uint32_t{0};
static_assert(RayPacket::kMax == 32);

/// Which rays may hit a child: bit i for ray i.
SIMVIS_INLINE std::uint32_t rays_into(const RayPacket& packet, const SeenChildren& seen, unsigned lane) {
  if (seen.whole >> lane & 1) return kAllRays;
  // Much larger than the float32 rounding errors of the shears, which are at most 1.
  constexpr float kMargin = 0x1p-18f;
  const auto down = [](float v) { return v - kMargin * (1 + std::abs(v)); };
  const auto up = [](float v) { return v + kMargin * (1 + std::abs(v)); };
  const Float8 low_x = splat8(down(seen.low[0][lane])), high_x = splat8(up(seen.high[0][lane]));
  const Float8 low_y = splat8(down(seen.low[1][lane])), high_y = splat8(up(seen.high[1][lane]));
  std::uint32_t beside = 0;
  for (unsigned i = 0; i < RayPacket::kEights; ++i) {
    const Float8 x = packet.shears[0][i], y = packet.shears[1][i];
    beside |= bits_of((x < low_x) | (x > high_x) | (y < low_y) | (y > high_y)) << 8 * i;
  }
  return ~beside;
}

/// Whether all of `rays` have a hit nearer than `distance_m`.
SIMVIS_INLINE bool all_end_before(const RayPacket& packet, std::uint32_t rays, float distance_m) {
  std::uint32_t ended = 0;
  for (unsigned i = 0; i < RayPacket::kEights; ++i) ended |= bits_of(packet.end_m[i] < splat8(distance_m)) << 8 * i;
  return (rays & ~ended) == 0;
}

inline constexpr float kFarthestBox = std::numeric_limits<float>::max();

/// Prefetches the boxes of a node that is needed soon.
SIMVIS_INLINE void fetch(const WideNode& node) {
  for (int axis = 0; axis < 3; axis += 2) {
    __builtin_prefetch(&node.low[axis]);
    __builtin_prefetch(&node.high[axis]);
  }
}

struct WaitingBox {
  std::uint32_t child, primitives;  // as in WideNode
  float distance;
  std::uint32_t rays;
};

/// Traverses the tree with the rays of the packet whose bits are set in `rays`. Calls `visit` with each leaf that a ray
/// may hit, the number of its primitives, and the bits of the rays that may hit it. Nearer children of
/// a node are visited first. Calls `expect` for a leaf some time before `visit`. `visit` may lower planes.end.
template <typename Visit, typename Expect>
SIMVIS_INLINE void traverse(const WideBvh& tree, const RayPacket& packet, std::uint32_t rays, const TreePlanes& planes,
                            const Visit& visit, const Expect& expect) {
  if (tree.nodes().empty()) return;
  std::array<WaitingBox, Bvh::kMaxDepth * WideNode::kMax> stack;
  std::size_t waiting = 1;
  stack[0] = {0, 0, -kFarthestBox, rays};
  while (waiting > 0) {
    const WaitingBox next = stack[--waiting];
    if (next.distance > planes.end) continue;
    if (all_end_before(packet, next.rays, (next.distance - planes.slack) * planes.m_per_length)) continue;
    if (next.primitives > 0) {
      visit(next.child, next.primitives, next.rays);
      continue;
    }
    const WideNode& node = tree.nodes()[next.child];
    const SeenChildren seen = see_children(packet, planes, node);
    const std::size_t below = waiting;
    for (unsigned left = seen.reached; left != 0; left &= left - 1) {
      const auto lane = static_cast<unsigned>(std::countr_zero(left));
      const std::uint32_t into = rays_into(packet, seen, lane) & next.rays;
      if (into == 0) continue;
      const WaitingBox child{node.child[lane], node.primitives[lane], seen.distance[lane], into};
      std::size_t at = waiting++;
      for (; at > below && stack[at - 1].distance < child.distance; --at) stack[at] = stack[at - 1];
      stack[at] = child;
      if (child.primitives == 0) {
        fetch(tree.nodes()[child.child]);
      } else {
        expect(child.child);
      }
    }
  }
}

}  // namespace simvis
