#include "engine/raycast/closest_hit.h"

#include <algorithm>
#include <utility>

#include "engine/base/assert.h"
#include "engine/draw/canonical_order.h"
#include "engine/draw/surface_alpha.h"
#include "engine/raycast/height_grid_traversal.h"
#include "engine/raycast/item_shape.h"
#include "engine/raycast/placing_error.h"

namespace simvis {

void RayView::begin(const DrawList& list, const RayInstances& items, const glm::dmat4& world_from_sensor,
                    HitSides sides) {
  list_ = &list;
  items_ = &items;
  world_from_sensor_ = world_from_sensor;
  sides_ = sides;
  ++cast_;
  seen_.resize(items.items().size());
  surfaces_.clear();
  grids_.clear();
}

const SeenItem& RayView::seen(std::uint32_t placed) {
  SeenItem& item = seen_[placed];
  if (item.cast != cast_) {
    item = see(items_->items()[placed], world_from_sensor_);
    item.cast = cast_;
    item.solid = is_solid_throughout(material(placed));
    item.passes_backs = sides_ == HitSides::front && has_back(material(placed), *this->placed(placed).mesh->mesh());
    item.mirrored = glm::determinant(item.placement.linear) < 0;
    add_shape(items_->items()[placed], item);
    add_grid(items_->items()[placed], item);
  }
  return item;
}

double RayView::item_world_error_m(const RayInstance& instance) const {
  return world_error_m(glm::length(glm::dvec3(instance.world_from_mesh[3])),
                       glm::length(glm::dvec3(world_from_sensor_[3])));
}

void RayView::add_shape(const RayInstance& instance, SeenItem& item) {
  const Mesh& mesh = *instance.mesh->mesh();
  if (!mesh.surface) return;
  const std::optional<SeenShape> surface = see_shape(*mesh.surface, item.placement, item_world_error_m(instance));
  if (!surface) return;
  item.surface = static_cast<std::uint32_t>(surfaces_.size());
  surfaces_.push_back(*surface);
}

// The plane of the grid has the frame of the mesh: x, y, z.
void RayView::add_grid(const RayInstance& instance, SeenItem& item) {
  if (!instance.mesh->is_grid()) return;
  static constexpr ExactSurface kPlaneOfGrid{.kind = SurfaceKind::plane, .axis = 2};
  const std::optional<SeenShape> frame = see_shape(kPlaneOfGrid, item.placement, item_world_error_m(instance));
  if (!frame) return;
  item.grid = static_cast<std::uint32_t>(grids_.size());
  grids_.push_back(*frame);
}

namespace {

// The vertices of a cell, row by row.
std::array<std::uint32_t, 4> vertices_of_cell(const GridSize& size, std::uint32_t cell) {
  const std::uint32_t cells = size.columns - 1, first = cell / cells * size.columns + cell % cells;
  return {first, first + 1, first + size.columns, first + size.columns + 1};
}

}  // namespace

// Where see_shape() gives a frame, a point of a ray and a corner of a triangle are displaced by less than 2^-32 of
// their distances in metres times the length of the row, see ray_surface.h. The test in double may meet a triangle that
// is nearly edge-on in front of it or behind it by more than that, which the factor of 4 allows for.
bool RayView::try_grid(const SeenShape& frame, const ShearedRay& ray, const glm::dvec3& direction, std::uint32_t placed,
                       const glm::dvec3& offset, ClosestHit& nearest) {
  constexpr double kGridPad = 0x1p-30;
  const Blas& blas = *this->placed(placed).mesh;
  const SeenItem& item = seen(placed);
  GridRay local{.from = frame.from};
  for (int i = 0; i < 3; ++i) local.way[i] = glm::dot(frame.rows[static_cast<std::size_t>(i)], direction);
  local.pad = kGridPad * (2 * frame.distance_m + item.reach_m) * frame.row_lengths;
  const MeshPlacement placement{item.placement.linear, offset};
  const auto end = [&] { return nearest.range_m * (1 + kGridPad); };
  bool found = false;
  traverse_grid(*blas.mesh(), *blas.pyramid(), local, nearest.t_min_m * (1 - kGridPad), end(), [&](std::uint32_t cell) {
    ++triangle_tests;
    const auto [a, b, c, d] = place_vertices(*blas.mesh(), vertices_of_cell(blas.pyramid()->size(), cell), placement);
    found |= try_triangle(ray, placed, 2 * cell, {a, c, d}, nearest);
    found |= try_triangle(ray, placed, 2 * cell + 1, {a, d, b}, nearest);
    return end();
  });
  return found;
}

bool RayView::try_surface(const SeenShape& surface, const glm::dvec3& direction, std::uint32_t placed,
                          ClosestHit& nearest) const {
  const SurfaceHits hits = intersect(surface, direction, false);
  for (unsigned i = 0; i < hits.count; ++i) {
    const auto& [range_m, bound_m, face, leaves] = hits.at[i];
    if (leaves && seen_[placed].passes_backs) continue;
    if (!is_nearer(range_m, placed, face, nearest)) continue;
    const Material& seen = material(placed);
    const bool is_solid_here =
        is_solid_throughout(seen) || is_solid(seen, shape_uv(surface, direction, range_m, face, seen.uv_set));
    if (!is_solid_here) continue;
    nearest = {range_m, placed, face, nearest.t_min_m};
    return true;
  }
  return false;
}

bool RayView::is_nearer(double range_m, std::uint32_t placed, std::uint32_t primitive,
                        const ClosestHit& nearest) const {
  if (range_m > nearest.range_m || range_m <= nearest.t_min_m) return false;
  return range_m != nearest.range_m || !comes_before(nearest, placed, primitive);
}

bool RayView::try_point(SeenShape& surface, const glm::dvec3& direction, std::uint32_t placed, std::uint32_t primitive,
                        ClosestHit& nearest) const {
  const Mesh& mesh = *this->placed(placed).mesh->mesh();
  set_point(surface, mesh, primitive);
  const SurfaceHits hits = intersect(surface, direction, false);
  for (unsigned i = 0; i < hits.count; ++i) {
    if (hits.at[i].leaves && seen_[placed].passes_backs) continue;
    if (!is_nearer(hits.at[i].range_m, placed, primitive, nearest)) continue;
    if (!is_solid_point(material(placed), mesh, primitive)) return false;
    nearest = {hits.at[i].range_m, placed, primitive, nearest.t_min_m};
    return true;
  }
  return false;
}

bool RayView::try_triangle(const ShearedRay& ray, std::uint32_t placed, std::uint32_t primitive,
                           const std::array<glm::dvec3, 3>& corners, ClosestHit& nearest) const {
  TriangleHit hit;
  if (!intersect(ray, corners, hit) || hit.range_m > nearest.range_m || hit.range_m <= nearest.t_min_m) return false;
  if (hit.range_m == nearest.range_m && comes_before(nearest, placed, primitive)) return false;
  const double area = hit.weights.x + hit.weights.y + hit.weights.z;
  const SeenItem& seen = seen_[placed];
  if (seen.passes_backs && shows_back(ray, area, seen.mirrored)) return false;
  if (!is_solid(material(placed), *this->placed(placed).mesh->mesh(), primitive, hit.weights / area)) return false;
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

RayHit RayView::finish(SeenShape shape, const glm::dvec3& direction, const ClosestHit& nearest) const {
  const std::uint32_t face = face_of_hit(shape, *placed(nearest.placed).mesh->mesh(), nearest.primitive);
  const SurfaceHit hit = find_hit(intersect(shape, direction, true), nearest.range_m, face);
  return {hit.range_m, hit.error_bound_m, placed(nearest.placed).item, nearest.primitive};
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
