#include "engine/embree_items.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <unordered_set>
#include <utility>

#include "engine/error.h"

namespace simvis {

namespace {

constexpr double kUnit = 0x1p-53;
// Per component 7 u (|linear| |p|) + 4 u |offset|: a product of two matrices (3), its product with a point and the sum
// (4), the difference of two places and its rotation (4). Then 3 u (|x| + |z|) for the shear, and again as much for
// the direction, whose components are products of cosines. In all 16 u (reach + distance), times sqrt(3).
constexpr double kPlacingRoundings = 16 * 1.7320508;
// World transforms come out of products of matrices with entries up to the offset from the world's origin: as many
// roundings as VertexRounding counts.
constexpr double kWorldRoundings = 3 * 4 * 1.7320508;

double frobenius(const glm::dmat3& m) {
  return std::sqrt(glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2]));
}

// Whether an item is too thin, or too small for its distance, for its rays to be brought to its unit frame. What that
// displaces them by, in radii, is (i) the inverse's own error, found from what is left of linear * inverse - 1 (and the
// 4 u with which that is found) and enlarged by what the inverse stretches; (ii) the rounding of places at this
// distance, 8 u each. Both together may take a sixteenth of the padding.
bool is_thin(const glm::dmat3& linear, const glm::dmat3& inverse, double radius, double distance_m) {
  const double stretch = frobenius(inverse), condition = frobenius(linear) * stretch;
  const double residue = frobenius(linear * inverse - glm::dmat3(1.0));
  const double displaced = condition * (residue + 4 * kUnit * condition) + 8 * kUnit * stretch * distance_m / radius;
  return !(displaced <= kPadding / 16);
}

}  // namespace

// One thread: the tree over items is made anew while its scanners wait, and waking others costs more than it takes.
ItemTree::ItemTree(RTCIntersectFunctionN on_item, RTCIntersectFunctionN on_triangle)
    : device_(rtcNewDevice("threads=1")), on_item_(on_item), on_triangle_(on_triangle) {
  if (device_ == nullptr)
    throw MachineError("Embree does not start: error " + std::to_string(rtcGetDeviceError(nullptr)));
}

void ItemTree::update(const DrawList& list, const glm::dvec3& world_sensor) {
  const bool restructured = take_structure(list);
  const bool moved_away = !anchored_ || !(glm::distance(world_sensor, origin_) <= kReach_m);
  if (moved_away) origin_ = world_sensor;
  anchored_ = true;
  if (place(list, restructured || moved_away) || restructured) build();
}

bool ItemTree::take_structure(const DrawList& list) {
  if (scene_ != nullptr && list.items == list_items_ && list.meshes == list_meshes_) return false;
  list_items_ = list.items;
  list_meshes_ = list.meshes;
  std::unordered_set<const Mesh*> wanted;
  items_.clear();
  for (std::uint32_t i = 0; i < list.items.size(); ++i) {
    const std::shared_ptr<const Mesh>& mesh = list.meshes[list.items[i].mesh];
    if (mesh->topology != Topology::triangles || mesh->indices.size() < 3) continue;
    wanted.insert(mesh.get());
    std::unique_ptr<MeshTree>& tree = trees_[mesh.get()];
    if (tree == nullptr) {
      tree = std::make_unique<MeshTree>(device_.get(), mesh, on_triangle_);
      ++counters_.meshes_built;
      counters_.triangles_built += tree->triangles();
    }
    if (tree->radius() > 0) items_.push_back({.item = i, .tree = tree.get()});
  }
  std::erase_if(trees_, [&](const auto& entry) { return !wanted.contains(entry.first); });
  return true;
}

// Whether any box is new.
bool ItemTree::place(const DrawList& list, bool everything) {
  bool changed = false;
  for (PlacedItem& item : items_) {
    const glm::dmat4& world_from_mesh = list.world_from_node[list.items[item.item].transform];
    if (!everything && world_from_mesh == item.world_from_mesh) continue;
    item.world_from_mesh = world_from_mesh;
    const glm::dmat3 linear(world_from_mesh);
    const glm::dvec3 half = item.tree->radius() * item.tree->half_size();
    const glm::dvec3 centre = glm::dvec3(world_from_mesh[3]) - origin_ + linear * item.tree->centre();
    const glm::dvec3 reach = glm::abs(linear[0]) * half.x + glm::abs(linear[1]) * half.y + glm::abs(linear[2]) * half.z;
    const double farthest = glm::length(glm::abs(centre) + reach);
    item.box = padded_bounds(centre - reach, centre + reach, kPadding * (farthest + kReach_m));
    ++counters_.items_placed;
    changed = true;
  }
  return changed;
}

void ItemTree::build() {
  if (scene_ == nullptr) {
    geometry_.reset(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_USER));
    rtcSetGeometryUserData(geometry_.get(), this);
    rtcSetGeometryBoundsFunction(geometry_.get(), bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry_.get(), on_item_);
    rtcSetGeometryBuildQuality(geometry_.get(), RTC_BUILD_QUALITY_LOW);
    scene_.reset(rtcNewScene(device_.get()));
    rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_DYNAMIC);
    rtcSetSceneBuildQuality(scene_.get(), RTC_BUILD_QUALITY_LOW);
    rtcAttachGeometry(scene_.get(), geometry_.get());
  }
  rtcSetGeometryUserPrimitiveCount(geometry_.get(), static_cast<unsigned>(items_.size()));
  rtcCommitGeometry(geometry_.get());
  rtcCommitScene(scene_.get());
  check_embree(device_.get());
  ++counters_.item_trees_built;
}

void ItemTree::bounds(const RTCBoundsFunctionArguments* arguments) {
  const ItemTree& tree = *static_cast<const ItemTree*>(arguments->geometryUserPtr);
  *arguments->bounds_o = tree.items_[arguments->primID].box;
}

SeenItem see(const PlacedItem& item, const glm::dmat4& world_from_sensor) {
  const glm::dvec3 place(item.world_from_mesh[3]), sensor(world_from_sensor[3]);
  SeenItem seen;
  seen.placement = place_mesh(item.world_from_mesh, world_from_sensor);
  const double radius = item.tree->radius(), stretch = frobenius(seen.placement.linear);
  const double reach_m = stretch * (glm::length(item.tree->centre()) + radius);
  const double distance_m = glm::length(seen.placement.offset);
  seen.corner_error_m = kUnit * (kPlacingRoundings * (reach_m + distance_m) +
                                 kWorldRoundings * (glm::length(place) + glm::length(sensor)));
  seen.centre = seen.placement.linear * item.tree->centre() + seen.placement.offset;
  const glm::dmat3 inverse = glm::inverse(seen.placement.linear);
  seen.unit_from_sensor = inverse / radius;
  seen.units_per_m = frobenius(seen.unit_from_sensor) / std::sqrt(3.0);
  seen.one_by_one =
      item.tree->scene() == nullptr || is_thin(seen.placement.linear, inverse, radius, reach_m + distance_m);
  return seen;
}

}  // namespace simvis
