#include "engine/bundle_walk.h"

#include <algorithm>
#include <array>
#include <bit>

#include "engine/bundle_tree_walk.h"
#include "engine/bundle_triangle.h"

namespace simvis {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr unsigned kAllLanes = (1u << RayBundle::kLanes) - 1;

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
        items, bundle_, kAllRays, planes, [&](std::uint32_t placed, std::uint32_t rays) __attribute__((always_inline)) {
          into_item(placed, rays);
          planes.end_at(farthest_m_);
        });
  }

  SIMVIS_INLINE void into_item(std::uint32_t placed, std::uint32_t rays) {
    ++view_.item_tests;
    const SeenItem& item = view_.seen(placed);
    const RayMesh& mesh = *view_.placed(placed).mesh;
    TreePlanes planes =
        planes_in(bundle_, item.scaled_linear, item.scaled_centre, item.scale, static_cast<float>(kPadding));
    planes.end_at(farthest_m_);
    walk_tree(
        mesh.tree(), bundle_, rays, planes, [&](std::uint32_t primitive, std::uint32_t) __attribute__((always_inline)) {
          if (!try_triangle(item, mesh, placed, primitive)) return;
          farthest_m_ = bundle_.farthest_m();
          bundle_.take_ends();
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
    if (!any(ahead > kZero4)) return false;
    ShearedExtent extent;
    if (!any(ahead <= kZero4)) {
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
  Walk(view, bundle).into_item(placed, kAllRays);
}

}  // namespace simvis
