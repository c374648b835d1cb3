#include "engine/raycast/ray_instances.h"

#include <algorithm>
#include <cmath>
#include <unordered_set>
#include <utility>

namespace simvis {

namespace {

constexpr double kItemUnit = 0x1p-53;
// The rounding of a placed corner, in units of u = 2^-53. Each component has an error of up to 7 u (|linear| |p|) + 4 u
// |offset|: the product of two matrices (3), its product with a point and the sum (4), the difference of two positions
// and its rotation (4). The shear adds 3 u (|x| + |z|). The direction, whose components are products of cosines, adds
// the same amount again. The total is 16 u (reach + distance), times sqrt(3).
constexpr double kPlacingRoundings = 16 * 1.7320508;
// World transforms are products of matrices with entries up to the offset from the world's origin. The number of
// roundings is the one in VertexRounding.
constexpr double kWorldRoundings = 3 * 4 * 1.7320508;

}  // namespace

double frobenius(const glm::dmat3& m) {
  return std::sqrt(glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2]));
}

void RayInstances::update(const DrawList& list, const glm::dvec3& world_sensor) {
  structure_changed_ = update_structure(list);
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
  if (made_ && list.changes.same_structure(version_)) return false;
  if (made_ && list.items == list_items_ && list.meshes == list_meshes_) return false;
  made_ = false;  // until the update is complete: the code below may throw
  // Only the first meshes are cached on disk. Later meshes may be new for each frame, as deforming meshes are.
  const std::filesystem::path cache = meshes_.empty() ? cache_ : "";
  items_.clear();
  std::unordered_set<const Mesh*> wanted;
  std::vector<std::uint32_t> transforms;
  for (std::uint32_t i = 0; i < list.items.size(); ++i) {
    const std::shared_ptr<const Mesh>& mesh = list.meshes[list.items[i].mesh];
    if (mesh->topology != Topology::triangles || mesh->indices.size() < 3) continue;
    wanted.insert(mesh.get());
    std::shared_ptr<const Blas>& made = meshes_[mesh.get()];
    if (made == nullptr) {
      made = shared_blas(mesh, cache, pool_);
      ++counters.meshes_built;
      counters.triangles_built += made->triangles();
    }
    if (made->radius() <= 0) continue;
    items_.push_back({.item = i, .mesh = made.get()});
    transforms.push_back(list.items[i].transform);
  }
  standing_ = StandingAt(transforms, list.world_from_node.size());
  std::erase_if(meshes_, [&](const auto& entry) { return !wanted.contains(entry.first); });
  list_items_ = list.items;
  list_meshes_ = list.meshes;
  made_ = true;
  return true;
}

void RayInstances::place(const DrawList& list, bool everything) {
  moved_.clear();
  const auto look = [&](std::uint32_t i) {
    const glm::dmat4& world_from_mesh = list.world_from_node[list.items[items_[i].item].transform];
    if (everything || world_from_mesh != items_[i].world_from_mesh) place(i, world_from_mesh);
  };
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
  const double reach_m = stretch * (glm::length(item.mesh->centre()) + radius);
  const double distance_m = glm::length(seen.placement.offset);
  seen.corner_error_m = kItemUnit * (kPlacingRoundings * (reach_m + distance_m) +
                                     kWorldRoundings * (glm::length(place) + glm::length(sensor)));
  const glm::dvec3 centre = seen.placement.linear * item.mesh->centre() + seen.placement.offset;
  // The last term makes sure that even the rounding errors in double here are small compared with kPadding.
  seen.scale = 1 / (stretch * radius + glm::length(centre) + 0x1p-20 * (reach_m + distance_m));
  seen.scaled_radius = seen.scale * stretch * radius / std::sqrt(3.0);
  seen.scaled_linear = glm::mat3(seen.scale * radius * seen.placement.linear);
  seen.scaled_centre = glm::vec3(seen.scale * centre);
  return seen;
}

}  // namespace simvis
