#include "engine/raycast/closest_hit.h"

#include <algorithm>
#include <utility>

#include "engine/base/assert.h"
#include "engine/draw/canonical_order.h"
#include "engine/draw/surface_alpha.h"
#include "engine/raycast/placing_error.h"

namespace simvis {

void RayView::begin(const DrawList& list, const RayInstances& items, const glm::dmat4& world_from_sensor) {
  list_ = &list;
  items_ = &items;
  world_from_sensor_ = world_from_sensor;
  ++cast_;
  seen_.resize(items.items().size());
  surfaces_.clear();
}

const SeenItem& RayView::seen(std::uint32_t placed) {
  SeenItem& item = seen_[placed];
  if (item.cast != cast_) {
    item = see(items_->items()[placed], world_from_sensor_);
    item.cast = cast_;
    item.solid = is_solid_throughout(*list_->materials[list_->items[items_->items()[placed].item].material]);
    add_shape(items_->items()[placed], item);
  }
  return item;
}

void RayView::add_shape(const RayInstance& instance, SeenItem& item) {
  const Mesh& mesh = *instance.mesh->mesh();
  if (!mesh.surface) return;
  const double world_m = world_error_m(glm::length(glm::dvec3(instance.world_from_mesh[3])),
                                       glm::length(glm::dvec3(world_from_sensor_[3])));
  const std::optional<SeenShape> surface = see_shape(*mesh.surface, item.placement, world_m);
  if (!surface) return;
  item.surface = static_cast<std::uint32_t>(surfaces_.size());
  surfaces_.push_back(*surface);
}

bool RayView::try_surface(const SeenShape& surface, const glm::dvec3& direction, std::uint32_t placed,
                          ClosestHit& nearest) const {
  const SurfaceHits hits = intersect(surface, direction, false);
  for (unsigned i = 0; i < hits.count; ++i) {
    const auto& [range_m, bound_m, face] = hits.at[i];
    if (range_m > nearest.range_m) return false;
    if (range_m <= nearest.t_min_m) continue;
    if (range_m == nearest.range_m && comes_before(nearest, placed, face)) continue;
    const Material& material = *list_->materials[list_->items[items_->items()[placed].item].material];
    if (!is_solid_throughout(material) && !is_solid(material, shape_uv(surface, direction, range_m, face))) continue;
    nearest = {range_m, placed, face, nearest.t_min_m};
    return true;
  }
  return false;
}

bool RayView::try_triangle(const ShearedRay& ray, std::uint32_t placed, std::uint32_t primitive,
                           const std::array<glm::dvec3, 3>& corners, ClosestHit& nearest) const {
  TriangleHit hit;
  if (!intersect(ray, corners, hit) || hit.range_m > nearest.range_m || hit.range_m <= nearest.t_min_m) return false;
  if (hit.range_m == nearest.range_m && comes_before(nearest, placed, primitive)) return false;
  const RayInstance& item = items_->items()[placed];
  const Material& material = *list_->materials[list_->items[item.item].material];
  const double area = hit.weights.x + hit.weights.y + hit.weights.z;
  if (!is_solid(material, *item.mesh->mesh(), primitive, hit.weights / area)) return false;
  nearest = {hit.range_m, placed, primitive, nearest.t_min_m};
  return true;
}

bool RayView::comes_before(const ClosestHit& nearest, std::uint32_t placed, std::uint32_t primitive) const {
  if (nearest.placed == placed) return nearest.primitive < primitive;
  const int order = canonical_compare(*list_, list_->items[this->placed(nearest.placed).item],
                                      list_->items[this->placed(placed).item]);
  return order != 0 ? order < 0 : std::pair(nearest.primitive, nearest.placed) < std::pair(primitive, placed);
}

// The offset of the item's placement. Same arithmetic as place_mesh().
glm::dvec3 RayView::offset_from(std::uint32_t placed, const glm::dvec3& world_m) const {
  const glm::dvec3 place(this->placed(placed).world_from_mesh[3]);
  return glm::transpose(glm::dmat3(world_from_sensor_)) * (place - world_m);
}

SeenShape RayView::surface_from(const SeenShape& surface, std::uint32_t placed, const glm::dvec3& world_m) const {
  const double place_m = glm::length(glm::dvec3(this->placed(placed).world_from_mesh[3]));
  return shape_seen_from(surface, offset_from(placed, world_m), world_error_m(place_m, glm::length(world_m)));
}

RayHit RayView::finish(const ShearedRay& ray, const glm::dvec3& direction, const ClosestHit& nearest) {
  if (nearest.range_m == std::numeric_limits<double>::infinity()) return {};
  const SeenItem& item = seen(nearest.placed);
  if (const SeenShape* const shape = surface(item)) return finish(*shape, direction, nearest);
  return finish(ray, nearest, item.placement, item.corner_error_m);
}

RayHit RayView::finish_from(const glm::dvec3& world_m, const ShearedRay& ray, const glm::dvec3& direction,
                            const ClosestHit& nearest) {
  if (nearest.range_m == std::numeric_limits<double>::infinity()) return {};
  const SeenItem& item = seen(nearest.placed);
  if (const SeenShape* const shape = surface(item)) {
    return finish(surface_from(*shape, nearest.placed, world_m), direction, nearest);
  }
  const MeshPlacement placement{item.placement.linear, offset_from(nearest.placed, world_m)};
  const double error_m =
      placing_error_m(item.reach_m, glm::length(placement.offset)) + world_error_m(item.place_m, glm::length(world_m));
  return finish(ray, nearest, placement, error_m);
}

RayHit RayView::finish(const SeenShape& shape, const glm::dvec3& direction, const ClosestHit& nearest) const {
  const SurfaceHit hit = find_hit(intersect(shape, direction, true), nearest.range_m, nearest.primitive);
  return {hit.range_m, hit.error_bound_m, placed(nearest.placed).item, hit.face};
}

RayHit RayView::finish(const ShearedRay& ray, const ClosestHit& nearest, const MeshPlacement& placement,
                       double corner_error_m) const {
  const auto corners = place_corners(*placed(nearest.placed).mesh->mesh(), nearest.primitive, placement);
  TriangleHit hit;
  SIMVIS_ASSERT(intersect(ray, corners, hit));
  return {hit.range_m, range_error_bound(ray, corners, hit, corner_error_m), placed(nearest.placed).item,
          nearest.primitive};
}

}  // namespace simvis
