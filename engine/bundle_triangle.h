// A bundle of rays and a triangle, in double, four rays at a time: the arithmetic of ray_triangle.cpp once more, to the
// bit the same. Part of bundle_walk.cpp, which is compiled without contracting products and sums into one rounding.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/ray_bundle.h"
#include "engine/ray_triangle.h"

namespace simvis {

inline constexpr Double4 kZero4{0, 0, 0, 0};

/// A triangle's corners in the sensor frame: lane by lane, the last is the first once more.
struct SeenTriangle {
  Double4 axis[3];

  std::array<glm::dvec3, 3> corners() const {
    const auto corner = [this](int k) { return glm::dvec3(axis[0][k], axis[1][k], axis[2][k]); };
    return {corner(0), corner(1), corner(2)};
  }
};

// As place_corners() does.
SIMVIS_INLINE SeenTriangle see_triangle(const Mesh& mesh, std::uint32_t primitive, const MeshPlacement& placement) {
  const std::uint32_t* const index = mesh.indices.data() + std::size_t{3} * primitive;
  const glm::vec3 &a = mesh.positions[index[0]], &b = mesh.positions[index[1]], &c = mesh.positions[index[2]];
  const Double4 x{a.x, b.x, c.x, a.x}, y{a.y, b.y, c.y, a.y}, z{a.z, b.z, c.z, a.z};
  const glm::dmat3& m = placement.linear;
  SeenTriangle seen;
  for (int i = 0; i < 3; ++i) {
    seen.axis[i] = all4(m[0][i]) * x + all4(m[1][i]) * y + all4(m[2][i]) * z + all4(placement.offset[i]);
  }
  return seen;
}

/// Where the sheared plane's point of the triangle is, if all of it lies ahead: from low to high.
struct ShearedExtent {
  double low_x = -std::numeric_limits<double>::infinity(), high_x = std::numeric_limits<double>::infinity(),
         low_y = -std::numeric_limits<double>::infinity(), high_y = std::numeric_limits<double>::infinity();
};

// Widened far beyond what double rounds.
SIMVIS_INLINE void widen(Double4 v, double& low, double& high) {
  low = std::min({v[0], v[1], v[2]});
  high = std::max({v[0], v[1], v[2]});
  const double slack = 0x1p-40 * (1 + std::max(std::abs(low), std::abs(high)));
  low -= slack;
  high += slack;
}

/// What is done with rays that the four of a batch may meet.
struct BatchHit {
  Mask4 hit;
  Double4 range_m;
  bool unsure = false;  // an edge's sign needs more digits
};

SIMVIS_INLINE BatchHit try_batch(const RayBundle& bundle, unsigned batch, Double4 x, Double4 y, Double4 z) {
  const Double4 sx = bundle.shear_x[batch], sy = bundle.shear_y[batch], per_z = bundle.per_z[batch];
  const Double4 ax = all4(x[0]) - sx * all4(z[0]), ay = all4(y[0]) - sy * all4(z[0]);
  const Double4 bx = all4(x[1]) - sx * all4(z[1]), by = all4(y[1]) - sy * all4(z[1]);
  const Double4 cx = all4(x[2]) - sx * all4(z[2]), cy = all4(y[2]) - sy * all4(z[2]);
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
  const Double4 area = u + v + w;
  const Double4 az = all4(z[0]) * per_z, bz = all4(z[1]) * per_z, cz = all4(z[2]) * per_z;
  const Double4 range = (u * az + v * bz + w * cz) / area;
  const Double4 low = least(least(az, bz), cz), high = most(most(az, bz), cz);
  result.range_m = range < low ? low : high < range ? high : range;
  result.hit &= (area != kZero4) & (result.range_m > kZero4) & (result.range_m <= bundle.range_m[batch]) &
                (result.range_m > bundle.beyond_m[batch]);
  return result;
}

// As range_error_bound() does, of hits on triangles of their own.
struct MetTriangles {
  Double4 a[3], b[3], c[3];  // corners in the sensor frame, by axes
  Double4 corner_error_m;
};

SIMVIS_INLINE Double4 sheared_length(Double4 x, Double4 y) { return sqrt4(x * x + y * y); }

SIMVIS_INLINE Double4 bounds_of_batch(const RayBundle& bundle, unsigned batch, const MetTriangles& t, bool& unsure) {
  constexpr double kUnit = 0x1p-53;
  const Double4 sx = bundle.shear_x[batch], sy = bundle.shear_y[batch], per_z = bundle.per_z[batch];
  const int x = bundle.x, y = bundle.y, z = bundle.z;
  const Double4 ax = t.a[x] - sx * t.a[z], ay = t.a[y] - sy * t.a[z];
  const Double4 bx = t.b[x] - sx * t.b[z], by = t.b[y] - sy * t.b[z];
  const Double4 cx = t.c[x] - sx * t.c[z], cy = t.c[y] - sy * t.c[z];
  const Double4 u1 = bx * cy, u2 = by * cx, v1 = cx * ay, v2 = cy * ax, w1 = ax * by, w2 = ay * bx;
  unsure = any((u1 == u2) | (v1 == v2) | (w1 == w2));
  const Double4 area = abs4((u1 - u2) + (v1 - v2) + (w1 - w2));
  const Double4 farthest = most(most(sheared_length(ax, ay), sheared_length(bx, by)), sheared_length(cx, cy));
  const Double4 range = bundle.range_m[batch];
  const Double4 az = t.a[z] * per_z, bz = t.b[z] * per_z, cz = t.c[z] * per_z;
  const Double4 below = most(kZero4, most(most(range - az, range - bz), range - cz));
  const Double4 above = most(kZero4, most(most(az - range, bz - range), cz - range));
  const Double4 size = most(most(abs4(az), abs4(bz)), abs4(cz));
  Double4 e[3], f[3];
  for (int i = 0; i < 3; ++i) {
    e[i] = t.b[i] - t.a[i];
    f[i] = t.c[i] - t.a[i];
  }
  const Double4 nx = e[1] * f[2] - f[1] * e[2], ny = e[2] * f[0] - f[2] * e[0], nz = e[0] * f[1] - f[0] * e[1];
  const Double4 normal = sqrt4(nx * nx + ny * ny + nz * nz);
  const Double4 slant = normal * abs4(per_z) / area;
  const Double4 weights = all4(6 * kUnit) * farthest * farthest / area * most(below, above);
  const Double4 of_place = t.corner_error_m * slant + weights + all4(6 * kUnit) * size;
  return least(of_place, most(below, above) + all4(2) * t.corner_error_m);
}

}  // namespace simvis
