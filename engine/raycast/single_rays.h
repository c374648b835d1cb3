// Traversal of trees by the rays of a packet one by one, in float32. Part of packet_cast.cpp.
//
// A packet shares box tests among its rays. Rays that lie farther apart than the triangles share few of them, and most
// of the time is spent waiting for memory. Such a ray is tested alone against the eight children of a node, so that it
// visits only nodes on its own path. The rays advance in rounds: one node for each ray, then one leaf for each ray.
// The data that a ray reads in a round was prefetched in the round before, while other rays were tested.
//
// Scattered rays, such as those of paths of light after a reflection, share no frustum. Each of them is tested alone
// against the boxes of the tree over items too, but all rays of the packet that may hit an item go through its mesh
// together, so that placing the rays and waiting for memory is shared.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include "engine/geometry/box_padding.h"
#include "engine/geometry/wide_bvh.h"
#include "engine/raycast/packet_traversal.h"
#include "engine/raycast/placing_error.h"
#include "engine/raycast/ray_instances.h"
#include "engine/raycast/ray_packet.h"

namespace simvis {

/// How many rays of the packet meet the same leaf of the item's mesh: an estimate for a surface that is perpendicular
/// to the rays, from the angles between the rays, the item's distance and the size of its leaves.
SIMVIS_INLINE double rays_per_leaf(const RayPacket& packet, const SeenItem& item, const Blas& mesh) {
  const double leaf = item.scaled_radius * mesh.leaf_size();
  const double depth = std::max<double>(item.scaled_radius, glm::length(item.scaled_centre));
  const double width = (packet.high[0] - packet.low[0]) * depth, height = (packet.high[1] - packet.low[1]) * depth;
  return packet.count * leaf * leaf / ((leaf + width) * (leaf + height));
}

/// The transform of rays from the sensor frame to the unit frame of a mesh. The point of a ray at the depth z along the
/// packet's axis is origin + t * direction, with t = t_per_depth * z and a direction of length up to sqrt(3).
struct MeshFromSensor {
  glm::dmat3 linear;   ///< the sum of its squared entries is 1
  glm::dvec3 origin;   ///< of the packet's apex
  double t_per_depth;  ///< also the factor from `linear` to the transform of a vector
  float slack;         ///< see MeshRays
  bool usable;  ///< false if a part is so flat, small or far away that the rounding errors would exceed the slack
};

SIMVIS_INLINE MeshFromSensor mesh_from_sensor(const RayPacket& packet, const SeenItem& item, const Blas& mesh) {
  // The condition number enters squared into the error of the origin, which then is 2^-30 of its distance.
  constexpr double kMaxCondition = 0x1p10, kMaxFactor = 0x1p40;
  const glm::dmat3 unit_to_sensor = mesh.radius() * item.placement.linear, inverse = glm::inverse(unit_to_sensor);
  const glm::dvec3 centre = item.centre_m - packet.apex_m;
  const double size = frobenius(inverse);
  MeshFromSensor to_mesh{
      .linear = (1 / size) * inverse, .origin = -(inverse * centre), .t_per_depth = size, .slack = 0, .usable = false};
  const double distance = glm::length(to_mesh.origin);
  const double from_m = packet.apex_distance_m + packet.spread_m;
  const double error_m = item.corner_error_m + placing_error_m(0, from_m) + world_error_m(0, from_m);
  to_mesh.slack = static_cast<float>(kPadding * (1 + distance + size * packet.spread_m) + 2 * size * error_m);
  to_mesh.usable = frobenius(unit_to_sensor) * size <= kMaxCondition && distance <= kMaxFactor && size <= kMaxFactor &&
                   size >= 1 / kMaxFactor;
  return to_mesh;
}

/// The rays of a packet in the frame of MeshFromSensor. A ray meets a plane of axis i at t = plane * per[i] -
/// origin[i] * per[i]. `enter` and `leave` are the last term for the planes where a ray enters and leaves a box, if the
/// box is larger by `slack` on each side. The rounding error of such a t is less than that of a displacement by
/// 8 half ulps of 1 + distance: the origin, the direction, its reciprocal, two products, two sums and the corners.
struct MeshRays {
  template <typename Value>
  using OfRays = std::array<Value, RayPacket::kMax / (sizeof(Value) / sizeof(float))>;

  union Values {
    OfRays<Float8> eights;
    OfRays<float> rays;
  };
  Values per[3], enter[3], leave[3];
  Values t_per_m;  ///< rounded up
};

/// A coordinate of the origins of eight rays.
SIMVIS_INLINE Float8 origins_along(const RayPacket& packet, const MeshFromSensor& to_mesh, unsigned eight, int axis) {
  if (!packet.own_origins) return splat8(static_cast<float>(to_mesh.origin[axis]));
  Double4 along[2];
  for (unsigned half = 0; half < 2; ++half) {
    along[half] = splat4(to_mesh.origin[axis]);
    for (int from = 0; from < 3; ++from) {
      along[half] += splat4(to_mesh.t_per_depth * to_mesh.linear[from][axis]) * packet.start_m[from][2 * eight + half];
    }
  }
  return to_floats(along[0], along[1]);
}

/// Returns which of `rays` may hit the box between -half_size and half_size before their nearest hits.
SIMVIS_INLINE std::uint32_t place_rays(const RayPacket& packet, const MeshFromSensor& to_mesh,
                                       const glm::vec3& half_size, std::uint32_t rays, MeshRays& placed) {
  // A component that is smaller than this changes t * direction by less than 2^-40 of the distance.
  constexpr float kSmallest = 0x1p-60f;
  const Float8 slack = splat8(to_mesh.slack);
  const Float8 t_per_depth = splat8(static_cast<float>((1 + 0x1p-20) * to_mesh.t_per_depth));
  std::uint32_t reached = 0;
  for (unsigned i = 0; i < RayPacket::kEights; ++i) {
    if ((rays >> 8 * i & 0xff) == 0) continue;
    const auto halves = [i](const Double4* values) __attribute__((always_inline)) {
      return to_floats(values[2 * i], values[2 * i + 1]);
    };
    const Float8 per_z = halves(packet.per_z);
    placed.t_per_m.eights[i] = t_per_depth / (per_z < splat8(0) ? -per_z : per_z);
    Float8 from = splat8(0), to = packet.end_m[i] * placed.t_per_m.eights[i];
    for (int axis = 0; axis < 3; ++axis) {
      const Double4 x = splat4(packet.sign * to_mesh.linear[packet.x][axis]),
                    y = splat4(packet.sign * to_mesh.linear[packet.y][axis]),
                    z = splat4(packet.sign * to_mesh.linear[packet.z][axis]);
      const Float8 direction = to_floats(x * packet.shear_x[2 * i] + y * packet.shear_y[2 * i] + z,
                                         x * packet.shear_x[2 * i + 1] + y * packet.shear_y[2 * i + 1] + z);
      const Mask8 parallel = (direction < splat8(kSmallest)) & (direction > splat8(-kSmallest));
      const Float8 per = splat8(1) / (parallel ? splat8(kSmallest) : direction), size = per < splat8(0) ? -per : per;
      const Float8 origin = origins_along(packet, to_mesh, i, axis) * per;
      placed.per[axis].eights[i] = per;
      placed.enter[axis].eights[i] = origin + slack * size;
      placed.leave[axis].eights[i] = origin - slack * size;
      const Float8 half = splat8(half_size[axis]) * size;
      from = max(from, -half - placed.enter[axis].eights[i]);
      to = min(to, half - placed.leave[axis].eights[i]);
    }
    reached |= bits_of(from <= to) << 8 * i;
  }
  return reached & rays;
}

/// The transform of rays from the sensor frame to that of the tree over items.
SIMVIS_INLINE MeshFromSensor tree_from_sensor(const RayPacket& packet, const glm::dmat4& world_from_sensor,
                                              const glm::dvec3& tree_origin) {
  const double size = std::sqrt(3.0);
  const glm::dmat3 turn(world_from_sensor);
  const glm::dvec3 origin = glm::dvec3(world_from_sensor[3]) - tree_origin + turn * packet.apex_m;
  return {.linear = (1 / size) * turn,
          .origin = origin,
          .t_per_depth = size,
          .slack = static_cast<float>(kPadding * (1 + glm::length(origin) + packet.spread_m)),
          .usable = true};
}

/// Which of `rays` may hit a child of a node before their nearest hits.
struct RaysIntoBox {
  std::uint32_t rays;
  float nearest;  ///< where the first of them enters, in their t
};

SIMVIS_INLINE RaysIntoBox rays_into_box(const RayPacket& packet, const MeshRays& placed, const WideNode& node,
                                        unsigned lane, std::uint32_t rays) {
  RaysIntoBox into{0, std::numeric_limits<float>::infinity()};
  for (unsigned i = 0; i < RayPacket::kEights; ++i) {
    if ((rays >> 8 * i & 0xff) == 0) continue;
    Float8 from = splat8(0), to = packet.end_m[i] * placed.t_per_m.eights[i];
    for (int axis = 0; axis < 3; ++axis) {
      const Float8 per = placed.per[axis].eights[i];
      const Float8 low = splat8(node.low[axis][lane]), high = splat8(node.high[axis][lane]);
      const Mask8 backwards = per < splat8(0);
      from = max(from, (backwards ? high : low) * per - placed.enter[axis].eights[i]);
      to = min(to, (backwards ? low : high) * per - placed.leave[axis].eights[i]);
    }
    const std::uint32_t in = bits_of(from <= to) & (rays >> 8 * i & 0xff);
    if (in == 0) continue;
    into.rays |= in << 8 * i;
    into.nearest = std::min(into.nearest, from[std::countr_zero(in)]);
  }
  return into;
}

/// Traverses the tree over items with `rays`, each of which is tested alone. Calls `visit` with each item and the bits
/// of the rays that may hit it.
template <typename Visit>
SIMVIS_INLINE void traverse_scattered(const WideBvh& tree, const RayPacket& packet, const MeshRays& placed,
                                      std::uint32_t rays, const Visit& visit) {
  if (tree.nodes().empty()) return;
  std::array<WaitingBox, Bvh::kMaxDepth * WideNode::kMax> stack;
  std::size_t waiting = 1;
  stack[0] = {0, 0, 0, rays};
  while (waiting > 0) {
    const WaitingBox next = stack[--waiting];
    if (next.primitives > 0) {
      visit(next.child, next.rays);
      continue;
    }
    const WideNode& node = tree.nodes()[next.child];
    const std::size_t below = waiting;
    for (unsigned lane = 0; lane < node.children; ++lane) {
      const RaysIntoBox into = rays_into_box(packet, placed, node, lane, next.rays);
      if (into.rays == 0) continue;
      const WaitingBox child{node.child[lane], node.primitives[lane], into.nearest, into.rays};
      std::size_t at = waiting++;
      for (; at > below && stack[at - 1].distance < child.distance; --at) stack[at] = stack[at - 1];
      stack[at] = child;
    }
  }
}

/// A ray on its way through a tree.
struct SingleRay {
  struct WaitingChild {
    std::uint32_t child, primitives;  // as in WideNode
    float t;                          // where the ray enters its box
  };

  unsigned number;  // in the packet
  float per[3], enter[3], leave[3];
  int near[3], far[3];  // planes of a box, as indices into WideNode::low and high one after the other
  float end;            // t of the nearest hit, rounded up
  std::uint32_t waiting;
  WaitingChild next;
  std::array<WaitingChild, Bvh::kMaxDepth * WideNode::kMax> stack;

  SIMVIS_INLINE void begin(const RayPacket& packet, const MeshRays& rays, unsigned ray) {
    number = ray;
    for (int axis = 0; axis < 3; ++axis) {
      per[axis] = rays.per[axis].rays[ray];
      enter[axis] = rays.enter[axis].rays[ray];
      leave[axis] = rays.leave[axis].rays[ray];
      near[axis] = per[axis] < 0 ? axis + 3 : axis;
      far[axis] = per[axis] < 0 ? axis : axis + 3;
    }
    end_at(packet, rays);
    waiting = 0;
    next = {0, 0, 0};
  }

  SIMVIS_INLINE void end_at(const RayPacket& packet, const MeshRays& rays) {
    const double range_m = packet.range_m[number / RayPacket::kLanes][number % RayPacket::kLanes];
    end = static_cast<float>(range_m) * (1 + 0x1p-22f) * rays.t_per_m.rays[number];
  }

  /// Makes the nearest waiting child `next`. Returns false if none is left before the nearest hit.
  SIMVIS_INLINE bool take() {
    while (waiting > 0) {
      next = stack[--waiting];
      if (next.t <= end) return true;
    }
    return false;
  }
};

/// Replaces the node `next` by its nearest child that the ray may hit; the other children wait. Returns false if the
/// ray is done.
template <typename Expect>
SIMVIS_INLINE bool open_node(SingleRay& ray, const std::vector<WideNode>& nodes, const Expect& expect) {
  const WideNode& node = nodes[ray.next.child];
  static_assert(offsetof(WideNode, high) == sizeof node.low);
  const Float8* const planes = &node.low[0];
  Float8 from = splat8(0), to = splat8(ray.end);
  for (int axis = 0; axis < 3; ++axis) {
    from = max(from, planes[ray.near[axis]] * ray.per[axis] - ray.enter[axis]);
    to = min(to, planes[ray.far[axis]] * ray.per[axis] - ray.leave[axis]);
  }
  float t[WideNode::kMax];
  std::memcpy(t, &from, sizeof t);
  const std::uint32_t below = ray.waiting;
  for (unsigned left = bits_of(from <= to) & ((1u << node.children) - 1); left != 0; left &= left - 1) {
    const auto lane = static_cast<unsigned>(std::countr_zero(left));
    const SingleRay::WaitingChild child{node.child[lane], node.primitives[lane], t[lane]};
    std::uint32_t at = ray.waiting++;
    for (; at > below && ray.stack[at - 1].t < child.t; --at) ray.stack[at] = ray.stack[at - 1];
    ray.stack[at] = child;
    if (child.primitives == 0) {
      fetch(nodes[child.child]);
    } else {
      expect(child.child);
    }
  }
  return ray.take();
}

/// Traverses the tree with the rays that `place_rays` returned. For each ray and leaf that it may hit, nearer leaves
/// first, calls `visit` with the number of the ray, the leaf and the number of its primitives. `visit` returns whether
/// the ray's nearest hit has changed. Before that it calls `expect` with the leaf, then `expect_indices`, then
/// `expect_corners`, and other rays advance after each call.
template <typename Visit, typename Expect, typename ExpectIndices, typename ExpectCorners>
SIMVIS_INLINE void traverse_singly(const WideBvh& tree, const RayPacket& packet, const MeshRays& placed,
                                   std::uint32_t reached, const Visit& visit, const Expect& expect,
                                   const ExpectIndices& expect_indices, const ExpectCorners& expect_corners) {
  SingleRay rays[RayPacket::kMax];
  // An entry is written before it is known whether the ray belongs there.
  SingleRay *at_node[RayPacket::kMax + 1], *at_leaf[RayPacket::kMax + 1];
  unsigned nodes = 0, leaves = 0;
  for (; reached != 0; reached &= reached - 1, ++nodes) {
    rays[nodes].begin(packet, placed, static_cast<unsigned>(std::countr_zero(reached)));
    at_node[nodes] = &rays[nodes];
  }
  const auto sort_in = [&](SingleRay * ray, bool goes_on) __attribute__((always_inline)) {
    const bool leaf = ray->next.primitives > 0;
    at_node[nodes] = at_leaf[leaves] = ray;
    nodes += static_cast<unsigned>(goes_on & !leaf);
    leaves += static_cast<unsigned>(goes_on & leaf);
  };
  while (nodes + leaves > 0) {
    for (unsigned i = 0, count = std::exchange(nodes, 0); i < count; ++i) {
      sort_in(at_node[i], open_node(*at_node[i], tree.nodes(), expect));
    }
    if (nodes > 0) continue;
    for (unsigned i = 0; i < leaves; ++i) expect_indices(at_leaf[i]->next.child);
    for (unsigned i = 0; i < leaves; ++i) expect_corners(at_leaf[i]->next.child);
    for (unsigned i = 0, count = std::exchange(leaves, 0); i < count; ++i) {
      SingleRay& ray = *at_leaf[i];
      if (visit(ray.number, ray.next.child, ray.next.primitives)) ray.end_at(packet, placed);
      sort_in(&ray, ray.take());
    }
  }
}

}  // namespace simvis
