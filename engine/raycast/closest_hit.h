// Decides in double which triangle a ray hits first. Every engine of ray_caster.h only finds candidates and uses this
// code.
#pragma once

#include <span>
#include <vector>

#include "engine/raycast/ray_instances.h"
#include "engine/raycast/ray_surface.h"

namespace simvis {

/// The nearest hit so far.
struct ClosestHit {
  double range_m = std::numeric_limits<double>::infinity();
  std::uint32_t placed = 0, primitive = 0;  ///< `placed` is an index into RayInstances::items()
  double t_min_m = 0;                       ///< hits at or before this range are skipped
};

/// The world as one sensor sees it. Each thread has its own: it transforms an item to the sensor frame when the first
/// ray comes near the item.
class RayView {
 public:
  /// Starts a new cast. Items that were transformed for the last cast are transformed again on demand.
  void begin(const DrawList& list, const RayInstances& items, const glm::dmat4& world_from_sensor,
             HitSides sides = HitSides::both);

  const glm::dmat4& world_from_sensor() const { return world_from_sensor_; }
  const RayInstances& items() const { return *items_; }
  const RayInstance& placed(std::uint32_t index) const { return items_->items()[index]; }
  const SeenItem& seen(std::uint32_t placed);

  /// Makes the triangle the nearest hit if the ray hits it at a solid point of a side that rays hit, beyond
  /// `nearest.t_min_m` and before `nearest`. seen() has been called with the item. Of two hits at the same range, the
  /// item that is first in canonical order wins (see engine/draw/canonical_order.h), then the lower primitive. Returns
  /// whether `nearest` changed.
  bool try_triangle(const ShearedRay& ray, std::uint32_t placed, std::uint32_t primitive,
                    const std::array<glm::dvec3, 3>& corners, ClosestHit& nearest) const;

  /// The shape that rays meet in place of the item's triangles; null if there is none. Valid until the next call.
  const SeenShape* surface(const SeenItem& item) const {
    return item.surface < surfaces_.size() ? &surfaces_[item.surface] : nullptr;
  }
  /// The same shape from a ray's own origin, in the world.
  SeenShape surface_from(const SeenShape& surface, std::uint32_t placed, const glm::dvec3& world_m) const;
  /// The frame of the grid of heights that rays go through in place of a tree over the item's triangles; null if there
  /// is none. Valid until the next call.
  const SeenShape* grid(const SeenItem& item) const { return item.grid < grids_.size() ? &grids_[item.grid] : nullptr; }
  /// As try_triangle(), with all triangles of the grid of an item. `frame` is that of grid(), or surface_from() of it
  /// for a ray with its own origin, and `offset` the placement of the item in the frame of the ray.
  bool try_grid(const SeenShape& frame, const ShearedRay& ray, const glm::dvec3& direction, std::uint32_t placed,
                const glm::dvec3& offset, ClosestHit& nearest);
  /// The offset of an item's placement for a ray with an origin of its own, in the world.
  glm::dvec3 offset_from(std::uint32_t placed, const glm::dvec3& world_m) const;

  /// Whether any item seen in this cast has a shape.
  bool has_surfaces() const { return !surfaces_.empty(); }

  /// As try_triangle(), with the shape of an item: `primitive` is the face.
  bool try_surface(const SeenShape& surface, const glm::dvec3& direction, std::uint32_t placed,
                   ClosestHit& nearest) const;

  /// As try_triangle(), with a point of the cloud of an item: `primitive` is its number. `surface` is that of the item,
  /// or surface_from() of it; its middle is set.
  bool try_point(SeenShape& surface, const glm::dvec3& direction, std::uint32_t placed, std::uint32_t primitive,
                 ClosestHit& nearest) const;

  /// The hit with its range along the ray and its error bound. `direction` is that of the ray.
  RayHit finish(const ShearedRay& ray, const glm::dvec3& direction, const ClosestHit& nearest);
  /// The same for a ray with an origin of its own, in the world.
  RayHit finish_from(const glm::dvec3& world_m, const ShearedRay& ray, const glm::dvec3& direction,
                     const ClosestHit& nearest);

  /// Below this value of rays_per_leaf() the rays of a packet go through a mesh one by one. Planar scans in 100,000
  /// triangles, with about this value, take as long either way.
  static constexpr double kMinRaysPerLeaf = 4;
  double min_rays_per_leaf = kMinRaysPerLeaf;  ///< tests set 0 (never one by one) and infinity (always)

  std::uint64_t item_tests = 0, triangle_tests = 0, single_rays = 0;  ///< totals of all casts, see RayCounters
  std::uint64_t finished_singly = 0;  ///< hits on triangles that were finished one by one, beside a hit on a shape

 private:
  void add_shape(const RayInstance& instance, SeenItem& item);
  void add_grid(const RayInstance& instance, SeenItem& item);
  double item_world_error_m(const RayInstance& instance) const;
  RayHit finish(const ShearedRay& ray, const ClosestHit& nearest, const MeshPlacement& placement,
                double corner_error_m) const;
  RayHit finish(SeenShape shape, const glm::dvec3& direction, const ClosestHit& nearest) const;
  bool is_nearer(double range_m, std::uint32_t placed, std::uint32_t primitive, const ClosestHit& nearest) const;
  const Material& material(std::uint32_t placed) const {
    return *list_->materials[list_->items[items_->items()[placed].item].material];
  }
  bool comes_before(const ClosestHit& nearest, std::uint32_t placed, std::uint32_t primitive) const;

  const DrawList* list_ = nullptr;
  const RayInstances* items_ = nullptr;
  glm::dmat4 world_from_sensor_{1.0};
  HitSides sides_ = HitSides::both;
  std::uint64_t cast_ = 0;
  std::vector<SeenItem> seen_;
  std::vector<SeenShape> surfaces_, grids_;  // of this cast, by SeenItem::surface and SeenItem::grid
};

/// Part of a cast's `t_min_m`; empty if `t_min_m` is empty.
inline std::span<const double> part_of(std::span<const double> t_min_m, std::size_t first, std::size_t count) {
  return t_min_m.empty() ? t_min_m : t_min_m.subspan(first, count);
}

}  // namespace simvis
