#include "engine/raycast/ray_instances.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/raycast/placing_error.h"

namespace simvis {

namespace {

bool can_be_hit(const Mesh& mesh) {
  if (is_solid_cloud(mesh)) return !mesh.indices.empty();
  return mesh.topology == Topology::triangles && mesh.indices.size() >= 3;
}

bool is_endless(const Mesh& mesh) { return mesh.surface && mesh.surface->kind == SurfaceKind::plane; }

}  // namespace

double frobenius(const glm::dmat3& m) {
  return std::sqrt(glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2]));
}

void RayInstances::update(const DrawList& list, std::span<const std::uint32_t> ignored,
                          const glm::dvec3& world_sensor) {
  structure_changed_ = update_structure(list);
  set_visible(list, ignored);
  const bool moved_away = !anchored_ || !reaches(world_sensor);
  if (moved_away) origin_ = world_sensor;
  anchored_ = true;
  place(list, structure_changed_ || moved_away);
  version_ = list.changes.version();
}

std::size_t RayInstances::in_reach(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> places_m) const {
  const auto outside = [&](const glm::dvec3& place_m) {
    return !reaches(glm::dvec3(world_from_sensor * glm::dvec4(place_m, 1)));
  };
  const auto end = std::find_if(places_m.begin() + 1, places_m.end(), outside);
  return static_cast<std::size_t>(end - places_m.begin());
}

bool RayInstances::update_structure(const DrawList& list) {
  replaced_.clear();
  meshes_changed_ = false;
  if (made_) {
    if (const auto changed = list.changes.items_since(version_)) {
      if (update_items(list, *changed)) return false;
    } else if (list.items == list_items_ && list.meshes == list_meshes_) {
      return false;
    }
  }
  made_ = false;  // until the update is complete: the code below may throw
  // Only the first meshes are cached on disk. Later meshes may be new for each frame, as deforming meshes are.
  const std::filesystem::path cache = meshes_.empty() ? cache_ : "";
  items_.clear();
  endless_.clear();
  placed_of_.assign(list.items.size(), kNotHit);
  for (auto& [mesh, held] : meshes_) held.uses = 0;
  std::vector<std::uint32_t> transforms;
  for (std::uint32_t i = 0; i < list.items.size(); ++i) {
    const std::shared_ptr<const Mesh>& mesh = list.meshes[list.items[i].mesh];
    // Hidden items get their trees when they become visible.
    if (!list.items[i].visible || !can_be_hit(*mesh)) continue;
    HeldBlas& held = blas_of(mesh, cache);
    ++held.uses;
    if (held.blas->radius() <= 0) continue;
    placed_of_[i] = static_cast<std::uint32_t>(items_.size());
    if (is_endless(*mesh)) endless_.push_back(placed_of_[i]);
    items_.push_back({.item = i, .mesh = held.blas.get()});
    transforms.push_back(list.items[i].transform);
  }
  standing_ = StandingAt(transforms, list.world_from_node.size());
  std::erase_if(meshes_, [](const auto& entry) { return entry.second.uses == 0; });
  list_items_ = list.items;
  list_meshes_ = list.meshes;
  made_ = true;
  return true;
}

// Returns whether the set of items stays the same. Items that were hidden until now, and meshes that can no longer be
// hit, change it.
bool RayInstances::update_items(const DrawList& list, std::span<const std::uint32_t> changed) {
  for (const std::uint32_t i : changed) {
    const DrawItem& item = list.items[i];
    const std::uint32_t placed = placed_of_[i];
    if (placed == kNotHit && item.visible && can_be_hit(*list.meshes[item.mesh])) return false;
    list_items_[i] = item;
    list_meshes_[item.mesh] = list.meshes[item.mesh];
    if (placed == kNotHit) continue;
    items_[placed].visible = item.visible;
    if (!replace_mesh(list, placed)) return false;
  }
  return true;
}

// An ignored item keeps its tree and its place.
void RayInstances::set_visible(const DrawList& list, std::span<const std::uint32_t> ignored) {
  const auto set = [&](std::uint32_t item, bool visible) {
    if (item < placed_of_.size() && placed_of_[item] != kNotHit) items_[placed_of_[item]].visible = visible;
  };
  for (const std::uint32_t item : ignored_) {
    if (item < list.items.size()) set(item, list.items[item].visible);
  }
  ignored_.assign(ignored.begin(), ignored.end());
  for (const std::uint32_t item : ignored_) set(item, false);
}

// Returns whether the item can be hit with its present mesh.
bool RayInstances::replace_mesh(const DrawList& list, std::uint32_t placed) {
  RayInstance& item = items_[placed];
  const std::shared_ptr<const Mesh>& mesh = list.meshes[list.items[item.item].mesh];
  const Mesh* const before = item.mesh->mesh().get();
  if (mesh.get() == before) return true;
  if (!can_be_hit(*mesh) || is_endless(*mesh) != is_endless(*before)) return false;
  HeldBlas& held = blas_of(mesh, "");
  if (held.blas->radius() <= 0) return false;
  ++held.uses;
  item.mesh = held.blas.get();
  if (const auto of_before = meshes_.find(before); --of_before->second.uses == 0) meshes_.erase(of_before);
  replaced_.push_back(placed);
  meshes_changed_ = true;
  return true;
}

RayInstances::HeldBlas& RayInstances::blas_of(const std::shared_ptr<const Mesh>& mesh,
                                              const std::filesystem::path& cache) {
  HeldBlas& held = meshes_[mesh.get()];
  if (held.blas == nullptr) {
    held.blas = shared_blas(mesh, cache, pool_);
    ++counters.meshes_built;
    if (!mesh->surface && !held.blas->is_grid()) counters.triangles_built += held.blas->triangles();
  }
  return held;
}

void RayInstances::place(const DrawList& list, bool everything) {
  moved_.clear();
  const auto look = [&](std::uint32_t i) {
    const glm::dmat4& world_from_mesh = list.world_from_node[list.items[items_[i].item].transform];
    if (everything || world_from_mesh != items_[i].world_from_mesh) place(i, world_from_mesh);
  };
  for (const std::uint32_t i : replaced_) place(i, list.world_from_node[list.items[items_[i].item].transform]);
  const auto written = everything ? std::nullopt : list.changes.moved_since(version_);
  if (!written) {
    for (std::uint32_t i = 0; i < items_.size(); ++i) look(i);
    return;
  }
  for (const TransformRange& entries : *written) std::ranges::for_each(standing_[entries], look);
}

void RayInstances::place(std::uint32_t placed, const glm::dmat4& world_from_mesh) {
  RayInstance& item = items_[placed];
  item.world_from_mesh = world_from_mesh;
  const glm::dmat3 linear(world_from_mesh);
  const glm::dvec3 half = item.mesh->radius() * item.mesh->half_size();
  const glm::dvec3 centre = glm::dvec3(world_from_mesh[3]) - origin_ + linear * item.mesh->centre();
  const glm::dvec3 reach = glm::abs(linear[0]) * half.x + glm::abs(linear[1]) * half.y + glm::abs(linear[2]) * half.z;
  const double farthest = glm::length(glm::abs(centre) + reach);
  item.box = padded_box(centre - reach, centre + reach, kPadding * (farthest + kReach_m));
  ++counters.items_placed;
  moved_.push_back(placed);
}

SeenItem see(const RayInstance& item, const glm::dmat4& world_from_sensor) {
  const glm::dvec3 place(item.world_from_mesh[3]), sensor(world_from_sensor[3]);
  SeenItem seen;
  seen.placement = place_mesh(item.world_from_mesh, world_from_sensor);
  const double radius = item.mesh->radius(), stretch = frobenius(seen.placement.linear);
  seen.reach_m = stretch * (glm::length(item.mesh->centre()) + radius);
  seen.place_m = glm::length(place);
  const double distance_m = glm::length(seen.placement.offset);
  seen.corner_error_m = placing_error_m(seen.reach_m, distance_m) + world_error_m(seen.place_m, glm::length(sensor));
  seen.centre_m = seen.placement.linear * item.mesh->centre() + seen.placement.offset;
  // The last term makes sure that even the rounding errors in double here are small compared with kPadding.
  seen.scale = 1 / (stretch * radius + glm::length(seen.centre_m) + 0x1p-20 * (seen.reach_m + distance_m));
  seen.scaled_radius = seen.scale * stretch * radius / std::sqrt(3.0);
  seen.scaled_linear = glm::mat3(seen.scale * radius * seen.placement.linear);
  seen.scaled_centre = glm::vec3(seen.scale * seen.centre_m);
  return seen;
}

}  // namespace simvis
