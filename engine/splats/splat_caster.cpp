#include "engine/splats/splat_caster.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "engine/base/assert.h"

namespace simvis {
namespace {

constexpr double kHalf = 0.5;

// Frobenius norm.
double norm_of(const glm::dmat3& m) {
  return std::sqrt(glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2]));
}

}  // namespace

void SplatCaster::set_world(const DrawList& list, RayCaster& surfaces) {
  surfaces_ = &surfaces;
  set_world(list);
}

void SplatCaster::set_world(const DrawList& list) {
  surfaces_->set_world(list);
  list_ = &list;
  placed_ = false;
  ignored_.clear();
}

void SplatCaster::ignore(std::span<const std::uint32_t> items) {
  surfaces_->ignore(items);
  if (std::ranges::equal(items, ignored_)) return;
  ignored_.assign(items.begin(), items.end());
  placed_ = false;
}

void SplatCaster::place_clouds() {
  if (placed_) return;
  placed_ = true;
  clouds_.clear();
  std::erase_if(trees_, [&](const auto& each) {
    return std::ranges::none_of(list_->meshes, [&](const auto& mesh) { return mesh->splats == each.first; });
  });
  for (std::uint32_t item = 0; item < list_->items.size(); ++item) {
    const DrawItem& drawn = list_->items[item];
    const auto& cloud = list_->meshes[drawn.mesh]->splats;
    if (!drawn.visible || cloud == nullptr || std::ranges::binary_search(ignored_, item)) continue;
    std::unique_ptr<SplatTree>& tree = trees_[cloud];
    if (tree == nullptr) tree = std::make_unique<SplatTree>(cloud);
    const glm::dmat4& world_from_mesh = list_->world_from_node[drawn.transform];
    const glm::dmat4 mesh_from_world = glm::inverse(world_from_mesh);
    const double norm = norm_of(glm::dmat3(mesh_from_world));
    if (!std::isfinite(norm)) continue;  // its item is flattened
    clouds_.push_back({.item = item,
                       .tree = tree.get(),
                       .mesh_from_world = mesh_from_world,
                       .linear_norm = norm,
                       .condition = norm * norm_of(glm::dmat3(world_from_mesh)),
                       .offset_m = glm::length(glm::dvec3(world_from_mesh[3]))});
  }
}

void SplatCaster::cast(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> directions,
                       std::span<RayHit> hits, std::span<const double> t_min_m, const HitsReady& there,
                       HitSides sides) {
  surfaces_->cast(world_from_sensor, directions, hits, t_min_m, {}, sides);
  stop_rays(world_from_sensor, {}, directions, t_min_m, hits);
  if (there) there(0, hits.size());
}

void SplatCaster::cast_from(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> origins_m,
                            std::span<const glm::dvec3> directions, std::span<RayHit> hits,
                            std::span<const double> t_min_m) {
  surfaces_->cast_from(world_from_sensor, origins_m, directions, hits, t_min_m);
  stop_rays(world_from_sensor, origins_m, directions, t_min_m, hits);
}

void SplatCaster::stop_rays(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> origins_m,
                            std::span<const glm::dvec3> directions, std::span<const double> t_min_m,
                            std::span<RayHit> hits) {
  SIMVIS_ASSERT(list_ != nullptr);
  place_clouds();
  if (clouds_.empty()) return;
  constexpr std::size_t kPiece = 64;
  const glm::dmat3 turn(world_from_sensor);
  parallel_for(directions.size(), kPiece, [&](std::size_t, std::size_t first, std::size_t count) {
    std::vector<Met> met;
    std::vector<SplatOnRay> found;
    for (std::size_t i = first; i < first + count; ++i) {
      const glm::dvec3 origin_m =
          glm::dvec3(world_from_sensor[3]) + (origins_m.empty() ? glm::dvec3(0) : turn * origins_m[i]);
      stop(origin_m, turn * directions[i], t_min_m.empty() ? 0 : t_min_m[i], hits[i], met, found);
    }
  });
}

// Orders splats as that of mixtures does: by range, then by what they look like.
bool SplatCaster::comes_before(const Met& a, const Met& b) {
  const auto row_of = [](const Met& met) {
    const SplatCloud& cloud = met.cloud->tree->cloud();
    const glm::vec3& color = cloud.harmonics[met.on_ray.splat * harmonics_count(cloud.degree)];
    return std::tuple(met.on_ray.range_m, met.on_ray.alpha, color.x, color.y, color.z, met.cloud->item,
                      met.on_ray.splat);
  };
  return row_of(a) < row_of(b);
}

// Rounding of a ray in the frame of the mesh: of its origin, some 16 roundings of the places in the world and of the
// inverse of a matrix, which its condition makes larger; of its direction, as many of the inverse and the product.
void SplatCaster::stop(const glm::dvec3& origin_m, const glm::dvec3& way, double t_min_m, RayHit& hit,
                       std::vector<Met>& met, std::vector<SplatOnRay>& found) const {
  constexpr double kRounding = 16 * 0x1p-53;
  met.clear();
  for (const PlacedCloud& cloud : clouds_) {
    const double direction_error = kRounding * cloud.condition * cloud.linear_norm;
    found.clear();
    cloud.tree->find({.origin = glm::dvec3(cloud.mesh_from_world * glm::dvec4(origin_m, 1)),
                      .direction = glm::dmat3(cloud.mesh_from_world) * way,
                      .origin_error = direction_error * (glm::length(origin_m) + cloud.offset_m),
                      .direction_error = direction_error,
                      .end_m = hit.range_m},
                     found);
    for (const SplatOnRay& each : found) met.push_back({each, &cloud});
  }
  std::ranges::sort(met, comes_before);
  double transmittance = 1;
  for (const Met& each : met) {
    transmittance *= 1 - each.on_ray.alpha;
    if (transmittance > kHalf || each.on_ray.range_m <= t_min_m) continue;
    hit = {each.on_ray.range_m, each.on_ray.error_bound_m, each.cloud->item, each.on_ray.splat};
    return;
  }
}

}  // namespace simvis
