#include "engine/raycast/packet_cast.h"

#include <algorithm>
#include <array>
#include <bit>
#include <type_traits>

#include "engine/raycast/own_origins.h"
#include "engine/raycast/packet_traversal.h"
#include "engine/raycast/packet_triangle.h"
#include "engine/raycast/single_rays.h"

namespace simvis {

namespace {

constexpr unsigned kAllLanes = (1u << RayPacket::kLanes) - 1;

/// The traversal of the world by one packet. `kOwn`: its rays have origins of their own.
template <bool kOwn>
class Traversal {
 public:
  SIMVIS_INLINE Traversal(RayView& view, RayPacket& packet)
      : view_(view), packet_(packet), farthest_m_(packet.farthest_m()) {}

  SIMVIS_INLINE void into_items(const WideBvh& items) {
    const glm::dmat3 turn = glm::transpose(glm::dmat3(view_.world_from_sensor()));
    const glm::dvec3 place = glm::dvec3(view_.world_from_sensor()[3]) - view_.items().origin();
    for (const std::uint32_t placed : view_.items().endless()) {
      if (view_.placed(placed).visible) into_item(placed, kAllRays);
    }
    if constexpr (kOwn) {
      if (packet_.kind == RayPacket::Kind::scattered) return into_items_scattered(items);
    }
    // The padding of item boxes is much larger than the rounding errors here.
    TreePlanes planes = kOwn ? planes_in(packet_, glm::mat3(turn), glm::vec3(-(turn * place) - packet_.apex_m), 1,
                                         static_cast<float>(spread_along_normal_m(packet_)))
                             : planes_in(packet_, glm::mat3(turn), glm::vec3(-(turn * place)), 1, 0);
    planes.end_at(farthest_m_);
    traverse(
        items, packet_, kAllRays, planes,
        [&](std::uint32_t placed, std::uint32_t, std::uint32_t rays) __attribute__((always_inline)) {
          if (!view_.placed(placed).visible) return;
          into_item(placed, rays);
          planes.end_at(farthest_m_);
        },
        [](std::uint32_t) {});
  }

  SIMVIS_INLINE void into_item(std::uint32_t placed, std::uint32_t rays) {
    ++view_.item_tests;
    const SeenItem& item = view_.seen(placed);
    const Blas& mesh = *view_.placed(placed).mesh;
    if (const SeenShape* const surface = view_.surface(item)) {
      return mesh.is_cloud() ? into_cloud(*surface, item, mesh, placed, rays) : into_surface(*surface, placed, rays);
    }
    if (mesh.is_cloud()) return;  // its transform flattens the points
    if (const SeenShape* const grid = view_.grid(item)) return into_grid(*grid, item, placed, rays);
    const WideBvh& tree = mesh.tree();
    if (goes_singly(item, mesh)) {
      const MeshFromSensor to_mesh = mesh_from_sensor(packet_, item, mesh);
      if (to_mesh.usable) return into_item_singly(to_mesh, item, mesh, placed, rays);
    }
    const glm::vec3 centre = kOwn ? glm::vec3(item.scale * (item.centre_m - packet_.apex_m)) : item.scaled_centre;
    const float slack = kOwn ? slack_of(packet_, item) : static_cast<float>(kPadding);
    TreePlanes planes = planes_in(packet_, item.scaled_linear, centre, item.scale, slack);
    planes.end_at(farthest_m_);
    const WideBvh::Leaf* const leaves = mesh.leaves().data();
    traverse(
        tree, packet_, rays, planes,
        [&](std::uint32_t leaf, std::uint32_t count, std::uint32_t into) __attribute__((always_inline)) {
          if (!try_leaf(item, mesh, placed, leaves[leaf], count, into)) return;
          packet_.update_ends();
          planes.end_at(farthest_m_);
        },
        [&](std::uint32_t leaf) { __builtin_prefetch(&leaves[leaf]); });
  }

  SIMVIS_INLINE void into_triangle(std::uint32_t placed, std::uint32_t primitive) {
    const Blas& mesh = *view_.placed(placed).mesh;
    try_leaf(view_.seen(placed), mesh, placed, {primitive, primitive, primitive, primitive}, 1, kAllRays);
  }

 private:
  SIMVIS_INLINE void into_items_scattered(const WideBvh& items) {
    MeshRays in_tree;
    const std::uint32_t rays =
        place_rays(packet_, tree_from_sensor(packet_, view_.world_from_sensor(), view_.items().origin()),
                   glm::vec3(std::numeric_limits<float>::infinity()), kAllRays, in_tree);
    traverse_scattered(
        items, packet_, in_tree, rays, [&](std::uint32_t placed, std::uint32_t into) __attribute__((always_inline)) {
          if (view_.placed(placed).visible) into_item(placed, into);
        });
  }

  SIMVIS_INLINE bool goes_singly(const SeenItem& item, const Blas& mesh) const {
    return packet_.kind == RayPacket::Kind::scattered || rays_per_leaf(packet_, item, mesh) < view_.min_rays_per_leaf;
  }

  // As into_item(), with the points of a cloud in place of triangles.
  SIMVIS_INLINE void into_cloud(const SeenShape& surface, const SeenItem& item, const Blas& mesh, std::uint32_t placed,
                                std::uint32_t rays) {
    const WideBvh& tree = mesh.tree();
    const WideBvh::Leaf* const leaves = mesh.leaves().data();
    const auto expect = [&](std::uint32_t leaf) { __builtin_prefetch(&leaves[leaf]); };
    MeshFromSensor to_mesh{};
    if (goes_singly(item, mesh)) to_mesh = mesh_from_sensor(packet_, item, mesh);
    if (to_mesh.usable) {
      MeshRays in_mesh;
      const std::uint32_t reached = place_rays(packet_, to_mesh, glm::vec3(mesh.half_size()), rays, in_mesh);
      if (reached == 0) return;
      view_.single_rays += static_cast<unsigned>(std::popcount(reached));
      const std::uint32_t* const indices = mesh.mesh()->indices.data();
      const glm::vec3* const positions = mesh.mesh()->positions.data();
      const VertexAttributes* const normals =
          is_cloud_of_discs(*mesh.mesh()) ? mesh.mesh()->attributes.data() : nullptr;
      traverse_singly(
          tree, packet_, in_mesh, reached,
          [&](unsigned ray, std::uint32_t leaf, std::uint32_t count)
              __attribute__((always_inline)) { return try_points(surface, placed, leaves[leaf], count, 1u << ray); },
          expect,
          [&](std::uint32_t leaf) {
            for (const std::uint32_t primitive : leaves[leaf]) __builtin_prefetch(&indices[primitive]);
          },
          [&](std::uint32_t leaf) {
            for (const std::uint32_t primitive : leaves[leaf]) {
              __builtin_prefetch(&positions[indices[primitive]]);
              if (normals != nullptr) __builtin_prefetch(&normals[indices[primitive]]);
            }
          });
      return;
    }
    const glm::vec3 centre = kOwn ? glm::vec3(item.scale * (item.centre_m - packet_.apex_m)) : item.scaled_centre;
    TreePlanes planes = planes_in(packet_, item.scaled_linear, centre, item.scale, slack_of(packet_, item));
    planes.end_at(farthest_m_);
    traverse(
        tree, packet_, rays, planes,
        [&](std::uint32_t leaf, std::uint32_t count, std::uint32_t into) __attribute__((always_inline)) {
          if (try_points(surface, placed, leaves[leaf], count, into)) planes.end_at(farthest_m_);
        },
        expect);
  }

  SIMVIS_INLINE void into_item_singly(const MeshFromSensor& to_mesh, const SeenItem& item, const Blas& mesh,
                                      std::uint32_t placed, std::uint32_t rays) {
    MeshRays in_mesh;
    const std::uint32_t reached = place_rays(packet_, to_mesh, glm::vec3(mesh.half_size()), rays, in_mesh);
    if (reached == 0) return;
    view_.single_rays += static_cast<unsigned>(std::popcount(reached));
    const WideBvh::Leaf* const leaves = mesh.leaves().data();
    const std::uint32_t* const indices = mesh.mesh()->indices.data();
    const glm::vec3* const positions = mesh.mesh()->positions.data();
    traverse_singly(
        mesh.tree(), packet_, in_mesh, reached,
        [&](unsigned ray, std::uint32_t leaf, std::uint32_t count)
            __attribute__((always_inline)) { return try_leaf_singly(item, mesh, placed, leaves[leaf], count, ray); },
        [&](std::uint32_t leaf) { __builtin_prefetch(&leaves[leaf]); },
        [&](std::uint32_t leaf) {
          for (const std::uint32_t primitive : leaves[leaf]) __builtin_prefetch(&indices[std::size_t{3} * primitive]);
        },
        [&](std::uint32_t leaf) {
          for (const std::uint32_t primitive : leaves[leaf]) {
            for (std::size_t k = 0; k < 3; ++k) __builtin_prefetch(&positions[indices[std::size_t{3} * primitive + k]]);
          }
        });
    packet_.update_ends();
    farthest_m_ = packet_.farthest_m();
  }

  // Tests one ray with the first `count` triangles of the leaf.
  SIMVIS_INLINE bool try_leaf_singly(const SeenItem& item, const Blas& mesh, std::uint32_t placed,
                                     const WideBvh::Leaf& leaf, std::uint32_t count, unsigned ray) {
    ++view_.triangle_tests;
    const unsigned batch = ray / RayPacket::kLanes, lane = ray % RayPacket::kLanes;
    SeenTriangles triangles = see_leaf(item, mesh, leaf);
    if constexpr (kOwn) {
      offsets_.place(packet_, view_, placed);
      triangles = shifted(triangles, offsets_.of(batch, lane));
    }
    TriangleLanes all;
    for (int k = 0; k < 3; ++k) {
      all.x[k] = triangles.at[k][packet_.x];
      all.y[k] = triangles.at[k][packet_.y];
      all.z[k] = triangles.at[k][packet_.z];
    }
    const RayLanes same_ray = spread_ray(packet_, batch, lane);
    BatchHit hit = try_lanes(same_ray, all);
    if (item.passes_backs) hit.hit = fronts_of(hit, same_ray.per_z, item.mirrored);
    bool found = false;
    for (unsigned left = (hit.unsure ? kAllLanes : bits_of(hit.hit)) & ((1u << count) - 1); left != 0;
         left &= left - 1) {
      const auto i = static_cast<unsigned>(std::countr_zero(left));
      const double range_m = packet_.range_m[batch][lane];
      if (hit.unsure || !item.solid || hit.range_m[i] == range_m) {
        found |= try_corners(batch, lane, placed, leaf[i], triangles.corners(i));
      } else if (hit.range_m[i] < range_m) {
        packet_.range_m[batch][lane] = hit.range_m[i];
        packet_.placed[batch][lane] = placed;
        packet_.primitive[batch][lane] = leaf[i];
        found = true;
      }
    }
    return found;
  }

  // Tests the first `count` triangles of the leaf.
  SIMVIS_INLINE bool try_leaf(const SeenItem& item, const Blas& mesh, std::uint32_t placed, const WideBvh::Leaf& leaf,
                              std::uint32_t count, std::uint32_t rays) {
    const SeenTriangles triangles = see_leaf(item, mesh, leaf);
    const ShearedExtents extents = extents_in(item, triangles);
    // The comparisons say which triangles to skip, so that a triangle with NaN extents is tested.
    Mask4 beside = ~extents.ahead | (extents.nearest_m > splat4(farthest_m_));
    for (int i = 0; i < 2; ++i) {
      beside |= (extents.low[i] > splat4(packet_.high[i])) | (extents.high[i] < splat4(packet_.low[i]));
    }
    bool found = false;
    for (unsigned left = ~bits_of(beside) & ((1u << count) - 1); left != 0; left &= left - 1) {
      const auto lane = static_cast<unsigned>(std::countr_zero(left));
      if (extents.nearest_m[lane] > farthest_m_) continue;
      if (!try_triangle(item, placed, leaf[lane], triangles, lane, batches_in(extents, lane) & batches_of(rays))) {
        continue;
      }
      farthest_m_ = packet_.farthest_m();
      found = true;
    }
    return found;
  }

  // Corners in the sensor frame; with own origins without the offset, which each ray adds.
  SIMVIS_INLINE static SeenTriangles see_leaf(const SeenItem& item, const Blas& mesh, const WideBvh::Leaf& leaf) {
    if constexpr (kOwn) return turn_triangles(*mesh.mesh(), leaf, item.placement.linear);
    return see_triangles(*mesh.mesh(), leaf, item.placement);
  }

  SIMVIS_INLINE ShearedExtents extents_in(const SeenItem& item, const SeenTriangles& triangles) const {
    if constexpr (!kOwn) return extents_of(packet_, triangles);
    return widened(packet_, shifted(triangles, item.placement.offset - packet_.apex_m), spread_at(packet_, item));
  }

  SIMVIS_INLINE bool try_triangle(const SeenItem& item, std::uint32_t placed, std::uint32_t primitive,
                                  const SeenTriangles& triangles, unsigned lane, unsigned batches) {
    if (batches == 0) return false;
    ++view_.triangle_tests;
    if constexpr (kOwn) offsets_.place(packet_, view_, placed);
    TriangleLanes triangle;
    for (int k = 0; k < 3; ++k) {
      triangle.x[k] = splat4(triangles.at[k][packet_.x][lane]);
      triangle.y[k] = splat4(triangles.at[k][packet_.y][lane]);
      triangle.z[k] = splat4(triangles.at[k][packet_.z][lane]);
    }
    bool found = false;
    for (; batches != 0; batches &= batches - 1) {
      const auto batch = static_cast<unsigned>(std::countr_zero(batches));
      BatchHit batch_hit = try_lanes(rays_of_batch(packet_, batch), seen_by_batch(triangle, batch));
      if (item.passes_backs) batch_hit.hit = fronts_of(batch_hit, packet_.per_z[batch], item.mirrored);
      if (batch_hit.unsure) {
        found |= try_one_by_one(batch, kAllLanes, placed, primitive, triangles.corners(lane));
      } else if (any(batch_hit.hit)) {
        found |= take(batch, batch_hit, item, placed, primitive, triangles, lane);
      }
    }
    return found;
  }

  SIMVIS_INLINE TriangleLanes seen_by_batch(TriangleLanes triangle, unsigned batch) const {
    if constexpr (kOwn) {
      for (int k = 0; k < 3; ++k) {
        triangle.x[k] += offsets_.at[packet_.x][batch];
        triangle.y[k] += offsets_.at[packet_.y][batch];
        triangle.z[k] += offsets_.at[packet_.z][batch];
      }
    }
    return triangle;
  }

  // The batches that may hit this triangle: bit i for batch i.
  SIMVIS_INLINE unsigned batches_in(const ShearedExtents& extents, unsigned lane) const {
    const Double4 low_x = splat4(extents.low[0][lane]), high_x = splat4(extents.high[0][lane]);
    const Double4 low_y = splat4(extents.low[1][lane]), high_y = splat4(extents.high[1][lane]);
    unsigned bits = 0;
    for (unsigned i = 0; i < RayPacket::kBatches / 4; ++i) {
      const Mask4 beside = (packet_.low_x[i] > high_x) | (packet_.high_x[i] < low_x) | (packet_.low_y[i] > high_y) |
                           (packet_.high_y[i] < low_y);
      bits |= bits_of(~beside) << 4 * i;
    }
    return bits & ((1u << packet_.batches) - 1);
  }

  SIMVIS_INLINE bool take(unsigned batch, const BatchHit& batch_hit, const SeenItem& item, std::uint32_t placed,
                          std::uint32_t primitive, const SeenTriangles& triangles, unsigned lane) {
    Double4& range_m = packet_.range_m[batch];
    const Mask4 hit = batch_hit.hit;
    if (!item.solid || any(hit & (batch_hit.range_m == range_m))) {
      return try_one_by_one(batch, bits_of(hit), placed, primitive, triangles.corners(lane));
    }
    range_m = hit ? batch_hit.range_m : range_m;
    const auto of_item = static_cast<long long>(placed), of_mesh = static_cast<long long>(primitive);
    packet_.placed[batch] = hit ? Mask4{of_item, of_item, of_item, of_item} : packet_.placed[batch];
    packet_.primitive[batch] = hit ? Mask4{of_mesh, of_mesh, of_mesh, of_mesh} : packet_.primitive[batch];
    return true;
  }

  // The batches that contain any of these rays: bit i for batch i.
  SIMVIS_INLINE static unsigned batches_of(std::uint32_t rays) {
    static_assert(RayPacket::kLanes == 4 && RayPacket::kBatches == 8);
    std::uint32_t each = rays | rays >> 2;
    each = (each | each >> 1) & 0x11111111;
    each = (each | each >> 3) & 0x03030303;
    each = (each | each >> 6) & 0x000f000f;
    return (each | each >> 12) & 0xff;
  }

  // Bit i of `rays` selects ray i.
  void into_surface(const SeenShape& surface, std::uint32_t placed, std::uint32_t rays);
  // Tests the first `count` points of the leaf. Returns whether a nearest hit changed.
  bool try_points(const SeenShape& surface, std::uint32_t placed, const WideBvh::Leaf& leaf, std::uint32_t count,
                  std::uint32_t rays);
  void into_grid(const SeenShape& grid, const SeenItem& item, std::uint32_t placed, std::uint32_t rays);
  // Calls `test` with the number of each of `rays` and its nearest hit, which it may replace. It returns whether it
  // did. Returns whether any hit was replaced.
  template <class Test>
  bool one_by_one(std::uint32_t rays, const Test& test);

  // Bit i of `lanes` selects lane i. These functions are not compiled for each machine (see SIMVIS_FOR_EACH_MACHINE),
  // so SIMD vectors cannot be passed to them. Corners are as in see_leaf().
  bool try_one_by_one(unsigned batch, unsigned lanes, std::uint32_t placed, std::uint32_t primitive,
                      const std::array<glm::dvec3, 3>& corners);

  // Corners are in the frame of the ray.
  bool try_corners(unsigned batch, unsigned lane, std::uint32_t placed, std::uint32_t primitive,
                   const std::array<glm::dvec3, 3>& corners);

  struct NoOffsets {};

  RayView& view_;
  RayPacket& packet_;
  double farthest_m_;
  [[no_unique_address]] std::conditional_t<kOwn, OwnOffsets, NoOffsets> offsets_;
};

template <bool kOwn>
template <class Test>
bool Traversal<kOwn>::one_by_one(std::uint32_t rays, const Test& test) {
  bool found = false;
  for (; rays != 0; rays &= rays - 1) {
    const auto index = static_cast<unsigned>(std::countr_zero(rays));
    if (index >= packet_.count) break;
    const unsigned batch = index / RayPacket::kLanes, lane = index % RayPacket::kLanes;
    ClosestHit nearest{packet_.range_m[batch][lane], static_cast<std::uint32_t>(packet_.placed[batch][lane]),
                       static_cast<std::uint32_t>(packet_.primitive[batch][lane]), packet_.t_min_m[batch][lane]};
    if (!test(index, nearest)) continue;
    packet_.range_m[batch][lane] = nearest.range_m;
    packet_.placed[batch][lane] = nearest.placed;
    packet_.primitive[batch][lane] = nearest.primitive;
    found = true;
  }
  if (!found) return false;
  packet_.update_ends();
  farthest_m_ = packet_.farthest_m();
  return true;
}

template <bool kOwn>
bool Traversal<kOwn>::try_points(const SeenShape& surface, std::uint32_t placed, const WideBvh::Leaf& leaf,
                                 std::uint32_t count, std::uint32_t rays) {
  return one_by_one(rays, [&](unsigned index, ClosestHit& nearest) {
    SeenShape shape = kOwn ? view_.surface_from(surface, placed, origin_of(packet_, index)) : surface;
    ++view_.triangle_tests;
    bool found = false;
    for (std::uint32_t i = 0; i < count; ++i) {
      found |= view_.try_point(shape, packet_.direction(index), placed, leaf[i], nearest);
    }
    return found;
  });
}

template <bool kOwn>
void Traversal<kOwn>::into_surface(const SeenShape& surface, std::uint32_t placed, std::uint32_t rays) {
  one_by_one(rays, [&](unsigned index, ClosestHit& nearest) {
    ++view_.triangle_tests;
    return kOwn ? view_.try_surface(view_.surface_from(surface, placed, origin_of(packet_, index)),
                                    packet_.direction(index), placed, nearest)
                : view_.try_surface(surface, packet_.direction(index), placed, nearest);
  });
}

template <bool kOwn>
void Traversal<kOwn>::into_grid(const SeenShape& grid, const SeenItem& item, std::uint32_t placed, std::uint32_t rays) {
  one_by_one(rays, [&](unsigned index, ClosestHit& nearest) {
    const ShearedRay ray = packet_.ray(index);
    const glm::dvec3& direction = packet_.direction(index);
    if constexpr (kOwn) {
      const glm::dvec3 origin_m = origin_of(packet_, index);
      return view_.try_grid(view_.surface_from(grid, placed, origin_m), ray, direction, placed,
                            view_.offset_from(placed, origin_m), nearest);
    } else {
      return view_.try_grid(grid, ray, direction, placed, item.placement.offset, nearest);
    }
  });
}

template <bool kOwn>
bool Traversal<kOwn>::try_one_by_one(unsigned batch, unsigned lanes, std::uint32_t placed, std::uint32_t primitive,
                                     const std::array<glm::dvec3, 3>& corners) {
  bool found = false;
  for (unsigned lane = 0; lane < RayPacket::kLanes; ++lane) {
    if (!(lanes >> lane & 1) || batch * RayPacket::kLanes + lane >= packet_.count) continue;
    std::array<glm::dvec3, 3> of_ray = corners;
    if constexpr (kOwn) {
      for (glm::dvec3& corner : of_ray) corner += offsets_.of(batch, lane);
    }
    found |= try_corners(batch, lane, placed, primitive, of_ray);
  }
  return found;
}

template <bool kOwn>
bool Traversal<kOwn>::try_corners(unsigned batch, unsigned lane, std::uint32_t placed, std::uint32_t primitive,
                                  const std::array<glm::dvec3, 3>& corners) {
  ClosestHit nearest{packet_.range_m[batch][lane], static_cast<std::uint32_t>(packet_.placed[batch][lane]),
                     static_cast<std::uint32_t>(packet_.primitive[batch][lane]), packet_.t_min_m[batch][lane]};
  const ShearedRay ray = packet_.ray(batch * RayPacket::kLanes + lane);
  if (!view_.try_triangle(ray, placed, primitive, corners, nearest)) return false;
  packet_.range_m[batch][lane] = nearest.range_m;
  packet_.placed[batch][lane] = nearest.placed;
  packet_.primitive[batch][lane] = nearest.primitive;
  return true;
}

SIMVIS_FOR_EACH_MACHINE void cast_into_items(RayView& view, const WideBvh& items, RayPacket& packet) {
  Traversal<false>(view, packet).into_items(items);
}

SIMVIS_FOR_EACH_MACHINE void cast_from_origins(RayView& view, const WideBvh& items, RayPacket& packet) {
  Traversal<true>(view, packet).into_items(items);
}

SIMVIS_FOR_EACH_MACHINE void cast_into_item(RayView& view, std::uint32_t placed, RayPacket& packet) {
  Traversal<false>(view, packet).into_item(placed, kAllRays);
}

SIMVIS_FOR_EACH_MACHINE void cast_into_triangle(RayView& view, std::uint32_t placed, std::uint32_t primitive,
                                                RayPacket& packet) {
  Traversal<false>(view, packet).into_triangle(placed, primitive);
}

}  // namespace

void traverse_packet(RayView& view, const WideBvh& items, RayPacket& packet) { cast_into_items(view, items, packet); }

void traverse_from_origins(RayView& view, const WideBvh& items, RayPacket& packet) {
  cast_from_origins(view, items, packet);
}

void traverse_packet(RayView& view, std::uint32_t placed, RayPacket& packet) { cast_into_item(view, placed, packet); }

void try_triangle(RayView& view, std::uint32_t placed, std::uint32_t primitive, RayPacket& packet) {
  cast_into_triangle(view, placed, primitive, packet);
}

}  // namespace simvis
