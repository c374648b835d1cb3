#include "sensors/raster_depth/shape_ranges.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/draw/surface_alpha.h"

namespace simvis {

namespace {

// Vertices of the polyhedron may stand out of the shape by the rounding of float32, which is far below this share.
constexpr double kInsideShare = 1e-6;

// Whether the sensor may be inside of a shape: it is in the box of the mesh, or close to it.
bool may_contain(const DrawList& list, const DrawItem& item, const glm::dvec3& sensor) {
  const Mesh& mesh = *list.meshes[item.mesh];
  if (mesh.surface->kind == SurfaceKind::plane) return false;
  const glm::dmat4& world_from_mesh = list.world_from_node[item.transform];
  const glm::dvec3 at = glm::inverse(glm::dmat3(world_from_mesh)) * (sensor - glm::dvec3(world_from_mesh[3]));
  const glm::dvec3 low(mesh.bounds_min), high(mesh.bounds_max);
  const glm::dvec3 room = kInsideShare * (high - low);
  // A transform that flattens the mesh gives NaN, which is not outside.
  return !(glm::any(glm::lessThan(at, low - room)) || glm::any(glm::greaterThan(at, high + room)));
}

}  // namespace

bool has_shapes(const DrawList& list) {
  return std::ranges::any_of(list.items, [&](const DrawItem& i) { return list.meshes[i.mesh]->surface && i.visible; });
}

void ShapeRanges::cast(const DrawList& list, const glm::dmat4& world_from_sensor,
                       std::span<const glm::dvec3> directions) {
  if (caster_ == nullptr) caster_ = make_host_ray_caster();
  const glm::dvec3 sensor(world_from_sensor[3]);
  shapes_.items.clear();
  solid_.clear();
  inside_ = false;
  for (const DrawItem& item : list.items) {
    if (!item.visible || !list.meshes[item.mesh]->surface) continue;
    shapes_.items.push_back({.mesh = item.mesh, .material = 0, .transform = item.transform});
    solid_.push_back(is_solid_throughout(*list.materials[item.material]));
    inside_ = inside_ || may_contain(list, item, sensor);
  }
  shapes_.meshes = list.meshes;
  shapes_.world_from_node = list.world_from_node;
  if (shapes_.materials.empty()) shapes_.materials = {std::make_shared<const Material>()};
  shapes_.material_revision.assign(1, 0);
  hits_.resize(directions.size());
  caster_->set_world(shapes_);
  caster_->cast(world_from_sensor, directions, hits_);
}

RangeEstimate ShapeRanges::widened(std::size_t beam, const RangeEstimate& rendered) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (hits_[beam].range_m == kInfinity) return rendered;
  const RayHit& shape = hits_[beam];
  const double farthest_m = (rendered.range_m + rendered.error_bound_m) * (1 + kInsideShare);
  if (!inside_ && shape.range_m - shape.error_bound_m > farthest_m) return rendered;
  if (!solid_[shape.item] || rendered.range_m == kInfinity) return {rendered.range_m, kInfinity};
  const double apart_m = std::abs(rendered.range_m - shape.range_m) + shape.error_bound_m;
  return {rendered.range_m, std::max(rendered.error_bound_m, apart_m)};
}

}  // namespace simvis
