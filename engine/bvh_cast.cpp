#include "engine/bvh_cast.h"

#include "engine/bvh_walk.h"

namespace simvis {

void cast_into_item(RayView& view, std::uint32_t placed, const CastRay& ray, NearestHit& nearest) {
  const SeenItem& item = view.seen(placed);
  const auto& mesh = static_cast<const BvhMesh&>(*view.placed(placed).mesh);
  const auto try_triangle = [&](std::uint32_t primitive) {
    view.try_triangle(ray.sheared, placed, primitive, place_corners(*mesh.mesh(), primitive, item.placement), nearest);
  };
  if (item.one_by_one) {
    for (std::uint32_t t = 0; t < mesh.triangles(); ++t) try_triangle(t);
    return;
  }
  UnitRay unit;
  if (!enter_mesh(item, mesh, ray.direction, nearest.range_m, unit)) return;
  walk_bvh(
      mesh.bvh(), {unit.from, unit.way}, kPadding,
      [&] { return (nearest.range_m - unit.start_m) * item.units_per_m * (1 + kPadding) + kPadding; }, try_triangle);
}

// The boxes of items are padded far beyond what double rounds.
void cast_into_items(RayView& view, const Bvh& items, const CastRay& ray, NearestHit& nearest) {
  const glm::dmat4& world_from_sensor = view.world_from_sensor();
  const BvhRay world_ray{glm::dvec3(world_from_sensor[3]) - view.items().origin(),
                         glm::dmat3(world_from_sensor) * ray.direction};
  walk_bvh(
      items, world_ray, 0, [&] { return nearest.range_m; },
      [&](std::uint32_t placed) { cast_into_item(view, placed, ray, nearest); });
}

}  // namespace simvis
