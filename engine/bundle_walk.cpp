// Compiled without contracting products and sums into one rounding, as ray_triangle.cpp is, whose arithmetic stands
// here once more for four rays at a time: to the bit the same.
#include "engine/bundle_walk.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

namespace simvis {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr Double4 kZero{0, 0, 0, 0};
constexpr unsigned kAllLanes = (1u << RayBundle::kLanes) - 1;
constexpr float kLargest = std::numeric_limits<float>::max();
constexpr std::uint32_t kLastNode = 0x7fffffff;  // above are things: see WideNode

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

struct Waiting {
  std::uint32_t node;
  float distance;
};

/// Calls `visit` with each thing that may be met, nearer ones first as far as boxes tell. `visit` may bring the planes'
/// end nearer.
template <typename Visit>
SIMVIS_INLINE void walk_tree(const WideBvh& tree, const TreePlanes& planes, const Visit& visit) {
  if (tree.nodes().empty()) return;
  std::array<Waiting, Bvh::kMaxDepth * WideNode::kMost> stack;
  std::size_t waiting = 1;
  stack[0] = {0, -kLargest};
  while (waiting > 0) {
    const Waiting next = stack[--waiting];
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
      const Waiting child{node.child[lane], distance[lane]};
      std::size_t at = waiting++;
      for (; at > below && stack[at - 1].distance < child.distance; --at) stack[at] = stack[at - 1];
      stack[at] = child;
    }
  }
}

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
  double low_x = -kInfinity, high_x = kInfinity, low_y = -kInfinity, high_y = kInfinity;
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
  const Mask4 below = (u < kZero) | (v < kZero) | (w < kZero), above = (u > kZero) | (v > kZero) | (w > kZero);
  result.hit = ~(below & above);
  if (!any(result.hit)) return result;
  const Double4 area = u + v + w;
  const Double4 az = all4(z[0]) * per_z, bz = all4(z[1]) * per_z, cz = all4(z[2]) * per_z;
  const Double4 range = (u * az + v * bz + w * cz) / area;
  const Double4 low = least(least(az, bz), cz), high = most(most(az, bz), cz);
  result.range_m = range < low ? low : high < range ? high : range;
  result.hit &= (area != kZero) & (result.range_m > kZero) & (result.range_m <= bundle.range_m[batch]) &
                (result.range_m > bundle.beyond_m[batch]);
  return result;
}

/// One bundle on its way through the world.
class Walk {
 public:
  SIMVIS_INLINE Walk(RayView& view, RayBundle& bundle)
      : view_(view), bundle_(bundle), farthest_m_(bundle.farthest_m()) {}

  SIMVIS_INLINE void into_items(const WideBvh& items) {
    const glm::dmat3 turn = glm::transpose(glm::dmat3(view_.world_from_sensor()));
    const glm::dvec3 place = glm::dvec3(view_.world_from_sensor()[3]) - view_.items().origin();
    // Boxes of items are padded far beyond what rounds here.
    TreePlanes planes = planes_in(bundle_, glm::mat3(turn), glm::vec3(-(turn * place)), 1, 0);
    planes.end_at(farthest_m_);
    walk_tree(
        items, planes, [&](std::uint32_t placed) __attribute__((always_inline)) {
          into_item(placed);
          planes.end_at(farthest_m_);
        });
  }

  SIMVIS_INLINE void into_item(std::uint32_t placed) {
    ++view_.item_tests;
    const SeenItem& item = view_.seen(placed);
    const RayMesh& mesh = *view_.placed(placed).mesh;
    TreePlanes planes =
        planes_in(bundle_, item.scaled_linear, item.scaled_centre, item.scale, static_cast<float>(kPadding));
    planes.end_at(farthest_m_);
    walk_tree(
        mesh.tree(), planes, [&](std::uint32_t primitive) __attribute__((always_inline)) {
          if (!try_triangle(item, mesh, placed, primitive)) return;
          farthest_m_ = bundle_.farthest_m();
          planes.end_at(farthest_m_);
        });
  }

  SIMVIS_INLINE void into_triangle(std::uint32_t placed, std::uint32_t primitive) {
    try_triangle(view_.seen(placed), *view_.placed(placed).mesh, placed, primitive);
  }

 private:
  SIMVIS_INLINE bool try_triangle(const SeenItem& item, const RayMesh& mesh, std::uint32_t placed,
                                  std::uint32_t primitive) {
    ++view_.triangle_tests;
    const SeenTriangle triangle = see_triangle(*mesh.mesh(), primitive, item.placement);
    const Double4 x = triangle.axis[bundle_.x], y = triangle.axis[bundle_.y], z = triangle.axis[bundle_.z];
    // A range lies between the depths of the corners.
    const Double4 ahead = z * all4(bundle_.sign);
    if (!any(ahead > kZero)) return false;
    ShearedExtent extent;
    if (!any(ahead <= kZero)) {
      if (!any(ahead * all4(bundle_.least_per_z) <= all4(farthest_m_))) return false;
      const Double4 per_z = all4(1) / z;
      widen(x * per_z, extent.low_x, extent.high_x);
      widen(y * per_z, extent.low_y, extent.high_y);
    }
    bool met = false;
    for (unsigned batches = batches_in(extent); batches != 0; batches &= batches - 1) {
      const auto batch = static_cast<unsigned>(std::countr_zero(batches));
      const BatchHit batch_hit = try_batch(bundle_, batch, x, y, z);
      if (batch_hit.unsure) {
        met |= try_one_by_one(batch, kAllLanes, placed, primitive, triangle.corners());
      } else if (any(batch_hit.hit)) {
        met |= take(batch, batch_hit, item, placed, primitive, triangle);
      }
    }
    return met;
  }

  // Bit i for batch i.
  SIMVIS_INLINE unsigned batches_in(const ShearedExtent& extent) const {
    unsigned bits = 0;
    for (unsigned i = 0; i < RayBundle::kBatches / 4; ++i) {
      // Not the other way round: what is not a number may be anywhere.
      const Mask4 beside = (bundle_.low_x[i] > all4(extent.high_x)) | (bundle_.high_x[i] < all4(extent.low_x)) |
                           (bundle_.low_y[i] > all4(extent.high_y)) | (bundle_.high_y[i] < all4(extent.low_y));
      bits |= bits_of(~beside) << 4 * i;
    }
    return bits & ((1u << bundle_.batches) - 1);
  }

  SIMVIS_INLINE bool take(unsigned batch, const BatchHit& batch_hit, const SeenItem& item, std::uint32_t placed,
                          std::uint32_t primitive, const SeenTriangle& triangle) {
    Double4& range_m = bundle_.range_m[batch];
    const Mask4 hit = batch_hit.hit;
    if (!item.solid || any(hit & (batch_hit.range_m == range_m))) {
      return try_one_by_one(batch, bits_of(hit), placed, primitive, triangle.corners());
    }
    range_m = hit ? batch_hit.range_m : range_m;
    const auto of_item = static_cast<long long>(placed), of_mesh = static_cast<long long>(primitive);
    bundle_.placed[batch] = hit ? Mask4{of_item, of_item, of_item, of_item} : bundle_.placed[batch];
    bundle_.primitive[batch] = hit ? Mask4{of_mesh, of_mesh, of_mesh, of_mesh} : bundle_.primitive[batch];
    return true;
  }

  // Bit i of `lanes` for lane i. Not a part of what is compiled for each machine: lanes themselves cannot be handed
  // over.
  bool try_one_by_one(unsigned batch, unsigned lanes, std::uint32_t placed, std::uint32_t primitive,
                      const std::array<glm::dvec3, 3>& corners);

  RayView& view_;
  RayBundle& bundle_;
  double farthest_m_;
};

bool Walk::try_one_by_one(unsigned batch, unsigned lanes, std::uint32_t placed, std::uint32_t primitive,
                          const std::array<glm::dvec3, 3>& corners) {
  bool met = false;
  for (unsigned lane = 0; lane < RayBundle::kLanes; ++lane) {
    const unsigned index = batch * RayBundle::kLanes + lane;
    if (!(lanes >> lane & 1) || index >= bundle_.count) continue;
    NearestHit nearest{bundle_.range_m[batch][lane], static_cast<std::uint32_t>(bundle_.placed[batch][lane]),
                       static_cast<std::uint32_t>(bundle_.primitive[batch][lane]), bundle_.beyond_m[batch][lane]};
    if (!view_.try_triangle(bundle_.ray(index), placed, primitive, corners, nearest)) continue;
    bundle_.range_m[batch][lane] = nearest.range_m;
    bundle_.placed[batch][lane] = nearest.placed;
    bundle_.primitive[batch][lane] = nearest.primitive;
    met = true;
  }
  return met;
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
  const Double4 below = most(kZero, most(most(range - az, range - bz), range - cz));
  const Double4 above = most(kZero, most(most(az - range, bz - range), cz - range));
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

SIMVIS_INLINE void finish(RayView& view, const RayBundle& bundle, unsigned batch, RayHit* hits) {
  MetTriangles met{};
  const unsigned first = batch * RayBundle::kLanes, lanes = std::min(RayBundle::kLanes, bundle.count - first);
  for (unsigned lane = 0; lane < lanes; ++lane) {
    if (bundle.range_m[batch][lane] == kInfinity) continue;
    const auto placed = static_cast<std::uint32_t>(bundle.placed[batch][lane]);
    const SeenItem& item = view.seen(placed);
    const auto primitive = static_cast<std::uint32_t>(bundle.primitive[batch][lane]);
    const SeenTriangle triangle = see_triangle(*view.placed(placed).mesh->mesh(), primitive, item.placement);
    for (int axis = 0; axis < 3; ++axis) {
      met.a[axis][lane] = triangle.axis[axis][0];
      met.b[axis][lane] = triangle.axis[axis][1];
      met.c[axis][lane] = triangle.axis[axis][2];
    }
    met.corner_error_m[lane] = item.corner_error_m;
  }
  bool unsure = false;
  const Double4 bounds = bounds_of_batch(bundle, batch, met, unsure);
  for (unsigned lane = 0; lane < lanes; ++lane) {
    const double range_m = bundle.range_m[batch][lane];
    const auto placed = static_cast<std::uint32_t>(bundle.placed[batch][lane]);
    const auto primitive = static_cast<std::uint32_t>(bundle.primitive[batch][lane]);
    if (range_m == kInfinity) {
      hits[first + lane] = {};
    } else if (unsure) {
      hits[first + lane] = view.finish(bundle.ray(first + lane), {range_m, placed, primitive});
    } else {
      hits[first + lane] = {range_m, bounds[lane], view.placed(placed).item, primitive};
    }
  }
}

}  // namespace

SIMVIS_FOR_EACH_MACHINE void try_triangle(RayView& view, std::uint32_t placed, std::uint32_t primitive,
                                          RayBundle& bundle) {
  Walk(view, bundle).into_triangle(placed, primitive);
}

SIMVIS_FOR_EACH_MACHINE void finish_bundle(RayView& view, const RayBundle& bundle, RayHit* hits) {
  for (unsigned batch = 0; batch < bundle.batches; ++batch) finish(view, bundle, batch, hits);
}

SIMVIS_FOR_EACH_MACHINE void walk_bundle(RayView& view, const WideBvh& items, RayBundle& bundle) {
  Walk(view, bundle).into_items(items);
}

SIMVIS_FOR_EACH_MACHINE void walk_bundle(RayView& view, std::uint32_t placed, RayBundle& bundle) {
  Walk(view, bundle).into_item(placed);
}

}  // namespace simvis
