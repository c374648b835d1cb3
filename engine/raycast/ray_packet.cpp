#include "engine/raycast/ray_packet.h"

#include <algorithm>
#include <bit>

namespace simvis {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Same choice as in ShearedRay.
int largest_axis(const glm::dvec3& direction) {
  const glm::dvec3 size = glm::abs(direction);
  return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

/// Transposes a 4x4 matrix.
SIMVIS_INLINE void transpose(const Double4* rows, Double4 (&columns)[4]) {
  const Double4 a = __builtin_shufflevector(rows[0], rows[1], 0, 4, 2, 6),
                b = __builtin_shufflevector(rows[0], rows[1], 1, 5, 3, 7),
                c = __builtin_shufflevector(rows[2], rows[3], 0, 4, 2, 6),
                d = __builtin_shufflevector(rows[2], rows[3], 1, 5, 3, 7);
  columns[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
  columns[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
  columns[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
  columns[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}

SIMVIS_INLINE double hmin(Double4 v) { return -hmax(-v); }

}  // namespace

unsigned RayPacket::side_of(const glm::dvec3& direction) {
  const int axis = largest_axis(direction);
  return 2 * static_cast<unsigned>(axis) + (direction[axis] < 0 ? 1 : 0);
}

RayPacket::RayPacket(std::span<const glm::dvec3> rays, std::span<const double> passed_m,
                     std::span<const RayOrigin> origins, Kind kind)
    : directions(rays.data()), kind(kind) {
  fill(*this, rays, passed_m, origins);
}

SIMVIS_FOR_EACH_MACHINE void RayPacket::fill(RayPacket& packet, std::span<const glm::dvec3> rays,
                                             std::span<const double> passed_m, std::span<const RayOrigin> origins) {
  packet.place(rays, passed_m, origins);
}

SIMVIS_INLINE void RayPacket::begin_at(const RayOrigin& first) {
  own_origins = true;
  apex_m = first.sensor_m;
  apex_distance_m = glm::length(apex_m);
}

// Returns how many of up to four rays start near the apex. SIMD lanes without a ray have the last ray's origin.
SIMVIS_INLINE unsigned RayPacket::set_origins(unsigned batch, std::span<const RayOrigin> origins) {
  const auto lanes = static_cast<unsigned>(origins.size());
  const auto origin = [&](unsigned lane) -> const RayOrigin& { return origins[std::min(lane, lanes - 1)]; };
  const RayOrigin &a = origin(0), &b = origin(1), &c = origin(2), &d = origin(3);
  Double4 square = splat4(0);
  for (int axis = 0; axis < 3; ++axis) {
    const Double4 start =
        Double4{a.sensor_m[axis], b.sensor_m[axis], c.sensor_m[axis], d.sensor_m[axis]} - splat4(apex_m[axis]);
    start_m[axis][batch] = start;
    world_m[axis][batch] = Double4{a.world_m[axis], b.world_m[axis], c.world_m[axis], d.world_m[axis]};
    square += start * start;
  }
  distance_m[batch] = Double4{a.distance_m, b.distance_m, c.distance_m, d.distance_m};
  const Mask4 near = square <= splat4(kind == Kind::bundle ? kMaxSpread_m * kMaxSpread_m : kInfinity);
  const unsigned count_near = std::min(lanes, static_cast<unsigned>(std::countr_one(bits_of(near))));
  if (count_near == lanes) spread_m = std::max(spread_m, hmax(square));  // its square until place() has all rays
  return count_near;
}

// Sets the axes of the packet from its first ray.
SIMVIS_INLINE void RayPacket::set_axes(const glm::dvec3& leading) {
  z = largest_axis(leading);
  x = (z + 1) % 3;
  y = (z + 2) % 3;
  sign = leading[z] < 0 ? -1 : 1;
}

// Returns how many of the first of four directions visit mostly the same boxes as the leading one.
SIMVIS_INLINE unsigned RayPacket::count_together(const glm::dvec3& leading, const Double4& along_x,
                                                 const Double4& along_y, const Double4& along_z) const {
  // If components are equal, the first one counts as the largest.
  const Mask4 x_loses_ties = splat4(x) > splat4(z), y_loses_ties = splat4(y) > splat4(z);
  const Double4 size_x = abs4(along_x), size_y = abs4(along_y), size_z = abs4(along_z);
  const Mask4 same_axis = ((size_z > size_x) | ((size_z == size_x) & x_loses_ties)) &
                          ((size_z > size_y) | ((size_z == size_y) & y_loses_ties));
  const Double4 cosine = splat4(leading[x]) * along_x + splat4(leading[y]) * along_y + splat4(leading[z]) * along_z;
  const Mask4 together =
      same_axis & (along_z * splat4(sign) > splat4(0)) & (cosine >= splat4(kind == Kind::bundle ? kMinCosine : -1));
  return static_cast<unsigned>(std::countr_one(bits_of(together)));
}

// Takes up to four of the next rays as one batch. Returns how many.
SIMVIS_INLINE unsigned RayPacket::take_batch(std::span<const glm::dvec3> rays, std::span<const double> passed_m,
                                             std::span<const RayOrigin> origins, Sums& sums) {
  const unsigned batch = count / kLanes, lanes = std::min(kLanes, static_cast<unsigned>(rays.size()) - count);
  const auto ray = [&](unsigned lane) -> const glm::dvec3& { return rays[count + std::min(lane, lanes - 1)]; };
  const glm::dvec3 &a = ray(0), &b = ray(1), &c = ray(2), &d = ray(3);
  Double4 along_x{a[x], b[x], c[x], d[x]}, along_y{a[y], b[y], c[y], d[y]}, along_z{a[z], b[z], c[z], d[z]};
  unsigned taken = std::min(lanes, count_together(rays[0], along_x, along_y, along_z));
  while (own_origins && taken > 0) {
    const unsigned near = set_origins(batch, origins.subspan(count, taken));
    if (near == taken) break;
    taken = near;
  }
  if (taken == 0) return 0;
  if (taken < kLanes) {
    const glm::dvec3& last = ray(taken - 1);
    for (unsigned lane = taken; lane < kLanes; ++lane) {
      along_x[lane] = last[x];
      along_y[lane] = last[y];
      along_z[lane] = last[z];
    }
  }
  // Same arithmetic as in ShearedRay.
  per_z[batch] = splat4(1) / along_z;
  shear_x[batch] = along_x / along_z;
  shear_y[batch] = along_y / along_z;
  sums.min_per_z = min(sums.min_per_z, abs4(per_z[batch]));
  sums.direction[0] += along_x;
  sums.direction[1] += along_y;
  sums.direction[2] += along_z;
  t_min_m[batch] = splat4(0);
  range_m[batch] = splat4(kInfinity);
  for (unsigned lane = taken; lane < kLanes; ++lane) range_m[batch][lane] = -1;
  if (!passed_m.empty()) {
    for (unsigned lane = 0; lane < taken; ++lane) t_min_m[batch][lane] = passed_m[count + lane];
  }
  placed[batch] = primitive[batch] = Mask4{};
  count += taken;
  ++batches;
  return taken;
}

// Repeats the last batch, without hits, in the batches that have no rays.
SIMVIS_INLINE void RayPacket::pad_batches() {
  for (unsigned batch = batches; batch < kBatches; ++batch) {
    range_m[batch] = splat4(-1);
    shear_x[batch] = shear_x[batches - 1];
    shear_y[batch] = shear_y[batches - 1];
    per_z[batch] = per_z[batches - 1];
    for (int axis = 0; own_origins && axis < 3; ++axis) {
      start_m[axis][batch] = start_m[axis][batches - 1];
      world_m[axis][batch] = world_m[axis][batches - 1];
    }
    if (own_origins) distance_m[batch] = distance_m[batches - 1];
  }
}

// Computes the bounds of the shears along one axis.
SIMVIS_INLINE void RayPacket::bound_shears(const Double4* exact, Double4* lows, Double4* highs, int axis) {
  for (unsigned i = 0; i < kBatches / 4; ++i) {
    Double4 columns[4];
    transpose(exact + 4 * i, columns);
    lows[i] = min(min(columns[0], columns[1]), min(columns[2], columns[3]));
    highs[i] = simvis::max(simvis::max(columns[0], columns[1]), simvis::max(columns[2], columns[3]));
  }
  for (unsigned i = 0; i < kEights; ++i) shears[axis][i] = to_floats(exact[2 * i], exact[2 * i + 1]);
  static_assert(kBatches == 8);
  low[axis] = hmin(min(lows[0], lows[1]));
  high[axis] = hmax(simvis::max(highs[0], highs[1]));
  low_shear[axis] = static_cast<float>(low[axis]);
  high_shear[axis] = static_cast<float>(high[axis]);
}

// `direction` is the sum of the rays' directions, along x, y and z, by lane.
SIMVIS_INLINE void RayPacket::set_planes(const Double4 (&direction)[3]) {
  glm::dvec3 middle;
  middle[x] = direction[0][0] + direction[0][1] + direction[0][2] + direction[0][3];
  middle[y] = direction[1][0] + direction[1][1] + direction[1][2] + direction[1][3];
  middle[z] = direction[2][0] + direction[2][1] + direction[2][2] + direction[2][3];
  glm::dvec3 normals[8] = {};
  const auto set_side = [&](int plane, int axis, double side, double shear) {
    normals[plane][axis] = side * sign;
    normals[plane][z] = -side * sign * shear;
  };
  set_side(0, x, 1, low[0]);
  set_side(1, x, -1, high[0]);
  set_side(2, y, 1, low[1]);
  set_side(3, y, -1, high[1]);
  normals[4][z] = sign;
  normals[5] = -glm::normalize(middle);
  for (int i = 0; i < 8; ++i) {
    normal_x[i] = static_cast<float>(normals[i].x);
    normal_y[i] = static_cast<float>(normals[i].y);
    normal_z[i] = static_cast<float>(normals[i].z);
  }
}

SIMVIS_INLINE void RayPacket::place(std::span<const glm::dvec3> rays, std::span<const double> passed_m,
                                    std::span<const RayOrigin> origins) {
  rays = rays.first(std::min<std::size_t>(kMax, rays.size()));
  set_axes(rays[0]);
  if (!origins.empty()) begin_at(origins[0]);
  Sums sums;
  while (count < rays.size() && take_batch(rays, passed_m, origins, sums) == kLanes) continue;
  min_per_z = hmin(sums.min_per_z);
  spread_m = std::sqrt(spread_m);
  pad_batches();
  bound_shears(shear_x, low_x, high_x, 0);
  bound_shears(shear_y, low_y, high_y, 1);
  update_ends();
  set_planes(sums.direction);
}

ShearedRay RayPacket::ray(unsigned index) const {
  ShearedRay ray;
  ray.x = x;
  ray.y = y;
  ray.z = z;
  ray.shear_x = shear_x[index / kLanes][index % kLanes];
  ray.shear_y = shear_y[index / kLanes][index % kLanes];
  ray.per_z = per_z[index / kLanes][index % kLanes];
  return ray;
}

}  // namespace simvis
