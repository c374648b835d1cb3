// Tests of a ray packet against triangles in double, four rays at a time, with results that are bit-identical to those
// of ray_triangle.cpp. Part of packet_cast.cpp and packet_finish.cpp, which are compiled without contraction of
// products and sums (-ffp-contract=off).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/geometry/wide_bvh.h"
#include "engine/raycast/ray_packet.h"
#include "engine/raycast/ray_triangle.h"

namespace simvis {

inline constexpr Double4 kZero4{0, 0, 0, 0};

/// The triangles of a leaf, one in each SIMD lane: corners in the sensor frame, indexed by corner and axis.
struct SeenTriangles {
  Double4 at[3][3];

  std::array<glm::dvec3, 3> corners(unsigned lane) const {
    const auto corner = [&](int k) { return glm::dvec3(at[k][0][lane], at[k][1][lane], at[k][2][lane]); };
    return {corner(0), corner(1), corner(2)};
  }
};

/// The corners without the offset of their placement. Same arithmetic as in place_corners().
SIMVIS_INLINE SeenTriangles turn_triangles(const Mesh& mesh, const WideBvh::Leaf& leaf, const glm::dmat3& m) {
  using Float4 = float __attribute__((vector_size(16)));
  const glm::vec3* const positions = mesh.positions.data();
  const std::uint32_t* corners[4];
  for (std::size_t lane = 0; lane < 4; ++lane) corners[lane] = mesh.indices.data() + std::size_t{3} * leaf[lane];
  SeenTriangles seen;
  for (int k = 0; k < 3; ++k) {
    const glm::vec3 &a = positions[corners[0][k]], &b = positions[corners[1][k]], &c = positions[corners[2][k]],
                    &d = positions[corners[3][k]];
    const Double4 x = __builtin_convertvector((Float4{a.x, b.x, c.x, d.x}), Double4),
                  y = __builtin_convertvector((Float4{a.y, b.y, c.y, d.y}), Double4),
                  z = __builtin_convertvector((Float4{a.z, b.z, c.z, d.z}), Double4);
    for (int i = 0; i < 3; ++i) {
      seen.at[k][i] = splat4(m[0][i]) * x + splat4(m[1][i]) * y + splat4(m[2][i]) * z;
    }
  }
  return seen;
}

SIMVIS_INLINE SeenTriangles shifted(SeenTriangles triangles, const glm::dvec3& offset) {
  for (auto& corner : triangles.at) {
    for (int axis = 0; axis < 3; ++axis) corner[axis] += splat4(offset[axis]);
  }
  return triangles;
}

// Same arithmetic as place_corners().
SIMVIS_INLINE SeenTriangles see_triangles(const Mesh& mesh, const WideBvh::Leaf& leaf, const MeshPlacement& placement) {
  return shifted(turn_triangles(mesh, leaf, placement.linear), placement.offset);
}

/// Extents of triangles in the sheared plane; infinite if a corner is not ahead of the sensor.
struct ShearedExtents {
  Double4 low[2], high[2];  ///< along x and y
  Double4 nearest_m;        ///< lower bound of the range of a hit
  Mask4 ahead;              ///< whether any corner is ahead of the sensor
};

SIMVIS_INLINE ShearedExtents extents_of(const RayPacket& packet, const SeenTriangles& triangles) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  // Much larger than the rounding errors in double.
  constexpr double kSlack = 0x1p-40;
  const Double4 z[3] = {triangles.at[0][packet.z], triangles.at[1][packet.z], triangles.at[2][packet.z]};
  const Double4 sign = splat4(packet.sign);
  const Double4 ahead[3] = {z[0] * sign, z[1] * sign, z[2] * sign};
  const Mask4 all = (ahead[0] > splat4(0)) & (ahead[1] > splat4(0)) & (ahead[2] > splat4(0));
  ShearedExtents extents;
  extents.ahead = (ahead[0] > splat4(0)) | (ahead[1] > splat4(0)) | (ahead[2] > splat4(0));
  extents.nearest_m = all ? min(min(ahead[0], ahead[1]), ahead[2]) * splat4(packet.min_per_z) : splat4(-kInfinity);
  const Double4 per_z[3] = {splat4(1) / z[0], splat4(1) / z[1], splat4(1) / z[2]};
  for (int i = 0; i < 2; ++i) {
    const int axis = i == 0 ? packet.x : packet.y;
    const Double4 a = triangles.at[0][axis] * per_z[0], b = triangles.at[1][axis] * per_z[1],
                  c = triangles.at[2][axis] * per_z[2];
    const Double4 low = min(min(a, b), c), high = max(max(a, b), c);
    const Double4 slack = splat4(kSlack) * (splat4(1) + max(abs4(low), abs4(high)));
    extents.low[i] = all ? low - slack : splat4(-kInfinity);
    extents.high[i] = all ? high + slack : splat4(kInfinity);
  }
  return extents;
}

/// The result of four tests of a ray against a triangle.
struct BatchHit {
  Mask4 hit;
  Double4 range_m;
  Double4 area;         // sum of the weights, see shows_back()
  bool unsure = false;  // the sign of an edge function needs more digits
};

/// Four triangles, or four times the same one, with their coordinates along the axes of a packet.
struct TriangleLanes {
  Double4 x[3], y[3], z[3];  ///< by corner
};

/// Four rays of a packet, or four times the same one. The members are as in RayPacket.
struct RayLanes {
  Double4 shear_x, shear_y, per_z, range_m, t_min_m;
};

SIMVIS_INLINE RayLanes rays_of_batch(const RayPacket& packet, unsigned batch) {
  return {packet.shear_x[batch], packet.shear_y[batch], packet.per_z[batch], packet.range_m[batch],
          packet.t_min_m[batch]};
}

SIMVIS_INLINE RayLanes spread_ray(const RayPacket& packet, unsigned batch, unsigned lane) {
  return {splat4(packet.shear_x[batch][lane]), splat4(packet.shear_y[batch][lane]), splat4(packet.per_z[batch][lane]),
          splat4(packet.range_m[batch][lane]), splat4(packet.t_min_m[batch][lane])};
}

/// Tests the ray of each SIMD lane against the triangle of the same lane.
SIMVIS_INLINE BatchHit try_lanes(const RayLanes& rays, const TriangleLanes& t) {
  const Double4 sx = rays.shear_x, sy = rays.shear_y, per_z = rays.per_z;
  const Double4 ax = t.x[0] - sx * t.z[0], ay = t.y[0] - sy * t.z[0];
  const Double4 bx = t.x[1] - sx * t.z[1], by = t.y[1] - sy * t.z[1];
  const Double4 cx = t.x[2] - sx * t.z[2], cy = t.y[2] - sy * t.z[2];
  const Double4 u1 = bx * cy, u2 = by * cx, v1 = cx * ay, v2 = cy * ax, w1 = ax * by, w2 = ay * bx;
  BatchHit result{};
  if (any((u1 == u2) | (v1 == v2) | (w1 == w2))) {
    result.unsure = true;
    return result;
  }
  const Double4 u = u1 - u2, v = v1 - v2, w = w1 - w2;
  const Mask4 below = (u < kZero4) | (v < kZero4) | (w < kZero4), above = (u > kZero4) | (v > kZero4) | (w > kZero4);
  result.hit = ~(below & above);
  if (!any(result.hit)) return result;
  const Double4 area = result.area = u + v + w;
  const Double4 az = t.z[0] * per_z, bz = t.z[1] * per_z, cz = t.z[2] * per_z;
  const Double4 range = (u * az + v * bz + w * cz) / area;
  const Double4 low = min(min(az, bz), cz), high = max(max(az, bz), cz);
  result.range_m = range < low ? low : high < range ? high : range;
  result.hit &=
      (area != kZero4) & (result.range_m > kZero4) & (result.range_m <= rays.range_m) & (result.range_m > rays.t_min_m);
  return result;
}

/// The hits that remain where rays pass the backs of triangles, as shows_back() decides.
SIMVIS_INLINE Mask4 fronts_of(const BatchHit& hit, const Double4& per_z, bool mirrored) {
  const Mask4 backs = ~((hit.area > kZero4) ^ (per_z > kZero4));
  return hit.hit & (mirrored ? backs : ~backs);
}

struct HitTriangle {
  std::array<glm::dvec3, 3> corners;  ///< in the sensor frame
  double corner_error_m = 0;
};

/// The triangles that four rays have hit, one in each SIMD lane.
struct HitTriangles {
  Double4 a[3], b[3], c[3];  ///< corners, indexed by axis
  Double4 corner_error_m;

  SIMVIS_INLINE explicit HitTriangles(const HitTriangle& all) : corner_error_m(splat4(all.corner_error_m)) {
    for (int axis = 0; axis < 3; ++axis) {
      a[axis] = splat4(all.corners[0][axis]);
      b[axis] = splat4(all.corners[1][axis]);
      c[axis] = splat4(all.corners[2][axis]);
    }
  }

  /// Sets the triangle of this SIMD lane and of all lanes after it.
  SIMVIS_INLINE void set_from(unsigned lane, const HitTriangle& t) {
    const Mask4 here = Mask4{0, 1, 2, 3} >= static_cast<long long>(lane);
    for (int axis = 0; axis < 3; ++axis) {
      a[axis] = here ? splat4(t.corners[0][axis]) : a[axis];
      b[axis] = here ? splat4(t.corners[1][axis]) : b[axis];
      c[axis] = here ? splat4(t.corners[2][axis]) : c[axis];
    }
    corner_error_m = here ? splat4(t.corner_error_m) : corner_error_m;
  }
};

SIMVIS_INLINE Double4 squared(Double4 x, Double4 y) { return x * x + y * y; }

// Same arithmetic as range_error_bound().
SIMVIS_INLINE Double4 bounds_of_batch(const RayPacket& packet, unsigned batch, const HitTriangles& t, bool& unsure) {
  constexpr double kUnit = 0x1p-53;
  const Double4 sx = packet.shear_x[batch], sy = packet.shear_y[batch], per_z = packet.per_z[batch];
  const int x = packet.x, y = packet.y, z = packet.z;
  const Double4 ax = t.a[x] - sx * t.a[z], ay = t.a[y] - sy * t.a[z];
  const Double4 bx = t.b[x] - sx * t.b[z], by = t.b[y] - sy * t.b[z];
  const Double4 cx = t.c[x] - sx * t.c[z], cy = t.c[y] - sy * t.c[z];
  const Double4 u1 = bx * cy, u2 = by * cx, v1 = cx * ay, v2 = cy * ax, w1 = ax * by, w2 = ay * bx;
  unsure = any((u1 == u2) | (v1 == v2) | (w1 == w2));
  const Double4 area = abs4((u1 - u2) + (v1 - v2) + (w1 - w2));
  const Double4 farthest = sqrt4(max(max(squared(ax, ay), squared(bx, by)), squared(cx, cy)));
  const Double4 range = packet.range_m[batch];
  const Double4 az = t.a[z] * per_z, bz = t.b[z] * per_z, cz = t.c[z] * per_z;
  const Double4 below = max(kZero4, max(max(range - az, range - bz), range - cz));
  const Double4 above = max(kZero4, max(max(az - range, bz - range), cz - range));
  const Double4 size = max(max(abs4(az), abs4(bz)), abs4(cz));
  Double4 e[3], f[3];
  for (int i = 0; i < 3; ++i) {
    e[i] = t.b[i] - t.a[i];
    f[i] = t.c[i] - t.a[i];
  }
  const Double4 nx = e[1] * f[2] - f[1] * e[2], ny = e[2] * f[0] - f[2] * e[0], nz = e[0] * f[1] - f[0] * e[1];
  const Double4 normal = sqrt4(nx * nx + ny * ny + nz * nz);
  const Double4 slant = normal * abs4(per_z) / area;
  const Double4 weights = splat4(6 * kUnit) * farthest * farthest / area * max(below, above);
  const Double4 of_place = t.corner_error_m * slant + weights + splat4(6 * kUnit) * size;
  return min(of_place, max(below, above) + splat4(2) * t.corner_error_m);
}

}  // namespace simvis
