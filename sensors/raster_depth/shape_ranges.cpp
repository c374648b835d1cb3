#include "sensors/raster_depth/shape_ranges.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

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

// Whether no item has changed since the last find().
bool ShapeRanges::is_known(const DrawList& list) const {
  if (!list.changes.same_structure(version_)) return false;
  const auto changed = list.changes.items_since(version_);
  return changed && changed->empty();
}

bool ShapeRanges::find(const DrawList& list) {
  if (is_known(list)) return !item_.empty();
  version_ = list.changes.version();
  item_.clear();
  shapes_.items.clear();
  shapes_.meshes.clear();
  std::unordered_map<std::uint32_t, std::uint32_t> own;  // numbers of meshes
  for (std::uint32_t i = 0; i < list.items.size(); ++i) {
    const DrawItem& item = list.items[i];
    if (!item.visible || !list.meshes[item.mesh]->surface) continue;
    const auto [mesh, is_new] = own.try_emplace(item.mesh, static_cast<std::uint32_t>(shapes_.meshes.size()));
    if (is_new) shapes_.meshes.push_back(list.meshes[item.mesh]);
    item_.push_back(i);
    shapes_.items.push_back(
        {.mesh = mesh->second, .material = 0, .transform = static_cast<std::uint32_t>(item_.size())});
  }
  return !item_.empty();
}

void ShapeRanges::place(const DrawList& list) {
  shapes_.world_from_node.assign(1, glm::dmat4(1));
  solid_.clear();
  for (const std::uint32_t i : item_) {
    const DrawItem& item = list.items[i];
    shapes_.world_from_node.push_back(list.world_from_node[item.transform]);
    solid_.push_back(is_solid_throughout(*list.materials[item.material]));
  }
}

void ShapeRanges::cast(const DrawList& list, const glm::dmat4& world_from_sensor,
                       std::span<const glm::dvec3> directions, unsigned threads) {
  if (caster_ == nullptr) {
    caster_ = make_host_ray_caster({}, threads);
    shapes_.materials = {std::make_shared<const Material>()};
    shapes_.material_revision = {0};
  }
  place(list);
  const glm::dvec3 sensor(world_from_sensor[3]);
  inside_ = std::ranges::any_of(item_, [&](std::uint32_t i) { return may_contain(list, list.items[i], sensor); });
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
