// Rays of a packet that have origins of their own. Part of packet_cast.cpp and packet_finish.cpp, which are compiled
// without contraction of products and sums (-ffp-contract=off).
//
// The packet is that of rays from its apex, and what it may hit is made larger by the spread of the origins: a ray from
// apex + e, with |e| at most `spread`, meets a box only if the ray from the apex meets the box that is larger by
// `spread`. The test in double then places each triangle in the frame of each ray: the frames differ in their origin
// alone, so a corner is turned once for all rays, and each ray adds its own offset. Hits and bounds are bit for bit
// those of a sensor at the ray's origin.
#pragma once

#include <cstdint>

#include "engine/raycast/closest_hit.h"
#include "engine/raycast/packet_triangle.h"
#include "engine/raycast/placing_error.h"
#include "engine/raycast/ray_packet.h"

namespace simvis {

/// The rounding of an origin that is brought to the sensor frame, and of the offsets: far below kPadding of the
/// distances involved, see SeenItem::scale.
inline constexpr double kOriginError = 0x1p-48;

/// By how much boxes in the sensor frame are made larger along a normal of up to sqrt(2), in metres.
SIMVIS_INLINE double spread_along_normal_m(const RayPacket& packet) {
  return 1.5 * packet.spread_m + kOriginError * packet.apex_distance_m;
}

/// The slack of TreePlanes for the tree of an item. The coordinates of the apex enter the sums of which kPadding bounds
/// the rounding.
SIMVIS_INLINE float slack_of(const RayPacket& packet, const SeenItem& item) {
  return static_cast<float>(kPadding * (1 + packet.apex_distance_m * item.scale) +
                            spread_along_normal_m(packet) * item.scale);
}

// Same arithmetic as place_mesh(): the offsets of four placements.
SIMVIS_INLINE void offsets_of(const RayPacket& packet, unsigned batch, const glm::dmat4& world_from_sensor,
                              const Double4 (&place_m)[3], Double4 (&offset)[3]) {
  const Double4 x = place_m[0] - packet.world_m[0][batch], y = place_m[1] - packet.world_m[1][batch],
                z = place_m[2] - packet.world_m[2][batch];
  for (int axis = 0; axis < 3; ++axis) {
    const glm::dvec4& column = world_from_sensor[axis];
    offset[axis] = splat4(column.x) * x + splat4(column.y) * y + splat4(column.z) * z;
  }
}

/// The offsets of an item's placement for all rays of a packet.
struct OwnOffsets {
  static constexpr std::uint32_t kNoItem = ~0u;
  std::uint32_t placed = kNoItem;  ///< the item
  Double4 at[3][RayPacket::kBatches];

  SIMVIS_INLINE void place(const RayPacket& packet, const RayView& view, std::uint32_t item) {
    if (placed == item) return;
    placed = item;
    const glm::dvec4& place = view.placed(item).world_from_mesh[3];
    const Double4 place_m[3] = {splat4(place.x), splat4(place.y), splat4(place.z)};
    for (unsigned batch = 0; batch < packet.batches; ++batch) {
      Double4 offset[3];
      offsets_of(packet, batch, view.world_from_sensor(), place_m, offset);
      for (int axis = 0; axis < 3; ++axis) at[axis][batch] = offset[axis];
    }
  }

  glm::dvec3 of(unsigned batch, unsigned lane) const {
    return {at[0][batch][lane], at[1][batch][lane], at[2][batch][lane]};
  }
};

inline glm::dvec3 origin_of(const RayPacket& packet, unsigned index) {
  const unsigned batch = index / RayPacket::kLanes, lane = index % RayPacket::kLanes;
  return {packet.world_m[0][batch][lane], packet.world_m[1][batch][lane], packet.world_m[2][batch][lane]};
}

/// The extents of extents_of(), for triangles in the frame of the apex and rays that start up to `spread_m` from it.
/// For a corner (x, z) with the shear s = x / z, a ray from (a, c) sees the shear s + (c s - a) / (z - c).
SIMVIS_INLINE ShearedExtents widened(const RayPacket& packet, const SeenTriangles& triangles, double spread_m) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  ShearedExtents extents = extents_of(packet, triangles);
  const Double4 sign = splat4(packet.sign), spread = splat4(spread_m);
  Double4 nearest = splat4(kInfinity), farthest = splat4(-kInfinity);
  for (const auto& corner : triangles.at) {
    nearest = min(nearest, corner[packet.z] * sign);
    farthest = max(farthest, corner[packet.z] * sign);
  }
  // Twice the spread, so that the division is well defined.
  const Mask4 all = nearest > spread + spread;
  extents.ahead = farthest > -spread;
  extents.nearest_m = all ? (nearest - spread) * splat4(packet.min_per_z) : splat4(-kInfinity);
  const Double4 per_depth = spread / (nearest - spread);
  for (int i = 0; i < 2; ++i) {
    const Double4 wider = per_depth * (splat4(1) + max(abs4(extents.low[i]), abs4(extents.high[i])));
    extents.low[i] = all ? extents.low[i] - wider : splat4(-kInfinity);
    extents.high[i] = all ? extents.high[i] + wider : splat4(kInfinity);
  }
  return extents;
}

/// By how much a ray's origin may be displaced from the apex when it meets a triangle of the item.
SIMVIS_INLINE double spread_at(const RayPacket& packet, const SeenItem& item) {
  return packet.spread_m * (1 + 0x1p-20) + 2 * item.corner_error_m + kOriginError * packet.apex_distance_m;
}

/// The items that the rays of a batch have hit, one in each SIMD lane.
struct HitItems {
  Double4 place_m[3], reach_m, from_world_m;

  SIMVIS_INLINE HitItems(RayView& view, std::uint32_t placed) { set_from(0, view, placed); }

  /// Sets the item of this SIMD lane and of all lanes after it.
  SIMVIS_INLINE void set_from(unsigned first, RayView& view, std::uint32_t placed) {
    const glm::dvec4& place = view.placed(placed).world_from_mesh[3];
    const SeenItem& item = view.seen(placed);
    for (unsigned lane = first; lane < RayPacket::kLanes; ++lane) {
      for (int axis = 0; axis < 3; ++axis) place_m[axis][lane] = place[axis];
      reach_m[lane] = item.reach_m;
      from_world_m[lane] = item.place_m;
    }
  }

  /// Moves triangles that were placed without an offset to the frame of each ray, and sets the errors of their corners.
  /// Same arithmetic as in see().
  SIMVIS_INLINE void move(const RayPacket& packet, unsigned batch, const glm::dmat4& world_from_sensor,
                          HitTriangles& triangles) const {
    Double4 offset[3];
    offsets_of(packet, batch, world_from_sensor, place_m, offset);
    for (int axis = 0; axis < 3; ++axis) {
      triangles.a[axis] += offset[axis];
      triangles.b[axis] += offset[axis];
      triangles.c[axis] += offset[axis];
    }
    const auto length = [](Double4 x, Double4 y, Double4 z) __attribute__((always_inline)) {
      return sqrt4(x * x + y * y + z * z);
    };
    const Double4 distance_m = length(offset[0], offset[1], offset[2]);
    triangles.corner_error_m = splat4(kPlacingError) * (reach_m + distance_m) +
                               splat4(kWorldError) * (from_world_m + packet.distance_m[batch]);
  }
};

}  // namespace simvis
