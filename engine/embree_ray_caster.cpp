#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <thread>
#include <utility>

#include "engine/assert.h"
#include "engine/embree_items.h"
#include "engine/ray_caster.h"
#include "engine/surface_alpha.h"

namespace simvis {

namespace {

// Rays that travel together: as many as most machines take at a time. Those of a scan are not so coherent that
// Embree's traversal for that would pay.
constexpr unsigned kLanes = 8;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Nearest {
  double range_m = kInfinity;
  std::uint32_t placed = 0, primitive = 0;  // of ItemTree::items(), which stand in the order of the list's items
};

/// What one thread works with: the world, and the items as the sensor sees them, made when a ray comes near.
struct SensorView {
  const DrawList* list = nullptr;
  const ItemTree* tree = nullptr;
  glm::dmat4 world_from_sensor{1.0};
  std::uint64_t cast = 0;
  std::uint64_t item_tests = 0, triangle_tests = 0;
  std::vector<SeenItem> seen;

  const SeenItem& item(std::uint32_t placed) {
    SeenItem& item = seen[placed];
    if (item.cast != cast) {
      item = see(tree->items()[placed], world_from_sensor);
      item.cast = cast;
    }
    return item;
  }
};

/// Up to 8 rays on their way. Embree hands the context back to the callbacks: it has to stand first.
struct Packet {
  RTCIntersectContext context;
  SensorView* view;
  glm::dvec3 direction[kLanes];
  ShearedRay ray[kLanes];
  Nearest nearest[kLanes];
  std::uint64_t item_tests, triangle_tests;
  // Of the item that is being walked: its rays in its unit frame, which begin at start_m.
  std::uint32_t placed;
  double start_m[kLanes];
  RTCRayHit8 local;
};
static_assert(std::is_standard_layout_v<Packet>);

void try_triangle(Packet& packet, unsigned lane, std::uint32_t primitive, const std::array<glm::dvec3, 3>& corners) {
  ++packet.triangle_tests;
  TriangleHit hit;
  Nearest& nearest = packet.nearest[lane];
  if (!intersect(packet.ray[lane], corners, hit) || hit.range_m > nearest.range_m) return;
  if (hit.range_m == nearest.range_m &&
      std::pair(nearest.placed, nearest.primitive) < std::pair(packet.placed, primitive)) {
    return;
  }
  const PlacedItem& item = packet.view->tree->items()[packet.placed];
  const Material& material = *packet.view->list->materials[packet.view->list->items[item.item].material];
  const double area = hit.weights.x + hit.weights.y + hit.weights.z;
  if (!is_solid(material, *item.tree->mesh(), primitive, hit.weights / area)) return;
  nearest = {hit.range_m, packet.placed, primitive};
}

void on_triangle(const RTCIntersectFunctionNArguments* arguments) {
  Packet& packet = *reinterpret_cast<Packet*>(arguments->context);
  RTCRayN* const rays = RTCRayHitN_RayN(arguments->rayhit, arguments->N);
  const MeshTree& tree = *static_cast<const MeshTree*>(arguments->geometryUserPtr);
  const SeenItem& item = packet.view->seen[packet.placed];
  const std::array<glm::dvec3, 3> corners = place_corners(*tree.mesh(), arguments->primID, item.placement);
  for (unsigned i = 0; i < arguments->N; ++i) {
    if (arguments->valid[i] != -1) continue;
    const unsigned lane = RTCRayN_id(rays, arguments->N, i);
    const double before_m = packet.nearest[lane].range_m;
    try_triangle(packet, lane, arguments->primID, corners);
    const double range_m = packet.nearest[lane].range_m;
    if (range_m < before_m) {
      RTCRayN_tfar(rays, arguments->N, i) = end_of_ray((range_m - packet.start_m[lane]) * item.units_per_m);
    }
  }
}

// Where the ray runs through the item's box, in its unit frame: false if it does not, before its nearest hit.
bool enter(const SeenItem& item, const glm::dvec3& half_size, Packet& packet, unsigned lane) {
  const glm::dvec3& direction = packet.direction[lane];
  const double middle_m = glm::dot(item.centre, direction);
  const glm::dvec3 middle = item.unit_from_sensor * (middle_m * direction - item.centre);
  const glm::dvec3 way = item.unit_from_sensor * direction;
  double first = -middle_m, last = packet.nearest[lane].range_m - middle_m;
  for (int axis = 0; axis < 3; ++axis) {
    const double half = half_size[axis] + 2 * kPadding;
    if (way[axis] == 0) {
      if (std::abs(middle[axis]) > half) return false;
      continue;
    }
    const double per_way = 1 / way[axis];
    const double s = (-half - middle[axis]) * per_way, t = (half - middle[axis]) * per_way;
    first = std::max(first, std::min(s, t));
    last = std::min(last, std::max(s, t));
  }
  if (!(first * item.units_per_m <= last * item.units_per_m + kPadding)) return false;
  const glm::vec3 from(middle + first * way), unit = float_direction(way / item.units_per_m);
  packet.start_m[lane] = middle_m + first;
  RTCRay8& rays = packet.local.ray;
  rays.org_x[lane] = from.x;
  rays.org_y[lane] = from.y;
  rays.org_z[lane] = from.z;
  rays.dir_x[lane] = unit.x;
  rays.dir_y[lane] = unit.y;
  rays.dir_z[lane] = unit.z;
  rays.tfar[lane] = end_of_ray((packet.nearest[lane].range_m - packet.start_m[lane]) * item.units_per_m);
  return true;
}

// Idle lanes, too, get what is valid: a build of Embree with assertions looks at them.
void clear(RTCRayHit8& rays) {
  rays = {};
  for (unsigned lane = 0; lane < kLanes; ++lane) {
    rays.ray.mask[lane] = ~0u;
    rays.ray.id[lane] = lane;
    rays.hit.geomID[lane] = rays.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
  }
}

void walk_one_by_one(Packet& packet, const MeshTree& tree, const MeshPlacement& placement, unsigned lanes) {
  for (std::uint32_t t = 0; t < tree.triangles(); ++t) {
    const std::array<glm::dvec3, 3> corners = place_corners(*tree.mesh(), t, placement);
    for (unsigned lane = 0; lane < kLanes; ++lane) {
      if (lanes >> lane & 1) try_triangle(packet, lane, t, corners);
    }
  }
}

void walk_tree(Packet& packet, const MeshTree& tree, const SeenItem& item, unsigned lanes) {
  alignas(32) int valid[kLanes] = {};
  bool any = false;
  for (unsigned lane = 0; lane < kLanes; ++lane) {
    if (!(lanes >> lane & 1) || !enter(item, tree.half_size(), packet, lane)) continue;
    valid[lane] = -1;
    any = true;
  }
  if (any) rtcIntersect8(valid, tree.scene(), &packet.context, &packet.local);
}

void on_item(const RTCIntersectFunctionNArguments* arguments) {
  Packet& packet = *reinterpret_cast<Packet*>(arguments->context);
  RTCRayN* const rays = RTCRayHitN_RayN(arguments->rayhit, arguments->N);
  const SeenItem& item = packet.view->item(arguments->primID);
  packet.placed = arguments->primID;
  unsigned lanes = 0;
  for (unsigned i = 0; i < arguments->N; ++i) {
    if (arguments->valid[i] != -1) continue;
    lanes |= 1u << RTCRayN_id(rays, arguments->N, i);
    ++packet.item_tests;
  }
  const MeshTree& tree = *packet.view->tree->items()[arguments->primID].tree;
  if (item.one_by_one) {
    walk_one_by_one(packet, tree, item.placement, lanes);
  } else {
    walk_tree(packet, tree, item, lanes);
  }
  for (unsigned i = 0; i < arguments->N; ++i) {
    if (arguments->valid[i] != -1) continue;
    RTCRayN_tfar(rays, arguments->N, i) = end_of_ray(packet.nearest[RTCRayN_id(rays, arguments->N, i)].range_m);
  }
}

RayHit finish(const Packet& packet, unsigned lane) {
  const Nearest& nearest = packet.nearest[lane];
  if (nearest.range_m == kInfinity) return {};
  const SeenItem& seen = packet.view->seen[nearest.placed];
  const PlacedItem& item = packet.view->tree->items()[nearest.placed];
  const auto corners = place_corners(*item.tree->mesh(), nearest.primitive, seen.placement);
  TriangleHit hit;
  SIMVIS_ASSERT(intersect(packet.ray[lane], corners, hit));
  return {hit.range_m, range_error_bound(packet.ray[lane], corners, hit, seen.corner_error_m), item.item,
          nearest.primitive};
}

void cast_packet(SensorView& view, std::span<const glm::dvec3> directions, std::span<RayHit> hits) {
  Packet packet;
  rtcInitIntersectContext(&packet.context);
  packet.view = &view;
  packet.item_tests = packet.triangle_tests = 0;
  const glm::vec3 from(glm::dvec3(view.world_from_sensor[3]) - view.tree->origin());
  const glm::dmat3 world_from_sensor(view.world_from_sensor);
  alignas(32) int valid[kLanes] = {};
  RTCRayHit8 rays;
  clear(rays);
  clear(packet.local);
  for (unsigned lane = 0; lane < directions.size(); ++lane) {
    const glm::vec3 way = float_direction(world_from_sensor * directions[lane]);
    packet.direction[lane] = directions[lane];
    packet.ray[lane] = ShearedRay(directions[lane]);
    rays.ray.org_x[lane] = from.x;
    rays.ray.org_y[lane] = from.y;
    rays.ray.org_z[lane] = from.z;
    rays.ray.dir_x[lane] = way.x;
    rays.ray.dir_y[lane] = way.y;
    rays.ray.dir_z[lane] = way.z;
    rays.ray.tfar[lane] = end_of_ray(kInfinity);
    valid[lane] = -1;
  }
  rtcIntersect8(valid, view.tree->scene(), &packet.context, &rays);
  for (unsigned lane = 0; lane < directions.size(); ++lane) hits[lane] = finish(packet, lane);
  view.item_tests += packet.item_tests;
  view.triangle_tests += packet.triangle_tests;
}

// How many threads are worth starting for so many rays: a thread costs about what some hundred rays do.
std::size_t thread_count(std::size_t rays) {
  constexpr std::size_t kRaysPerThread = 4096;
  return std::clamp<std::size_t>(rays / kRaysPerThread, 1, std::max(1u, std::thread::hardware_concurrency()));
}

void cast_all(SensorView& view, std::span<const glm::dvec3> directions, std::span<RayHit> hits) {
  for (std::size_t first = 0; first < directions.size(); first += kLanes) {
    const std::size_t count = std::min<std::size_t>(kLanes, directions.size() - first);
    cast_packet(view, directions.subspan(first, count), hits.subspan(first, count));
  }
}

class EmbreeRayCaster : public RayCaster {
 public:
  void set_world(const DrawList& list) override { world_ = &list; }
  void cast(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> directions,
            std::span<RayHit> hits) override;
  RayCounters counters() const override;

 private:
  const DrawList* world_ = nullptr;
  std::optional<ItemTree> tree_;   // from the first cast on
  std::vector<SensorView> views_;  // of each thread
  std::uint64_t casts_ = 0, rays_ = 0;
};

void EmbreeRayCaster::cast(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> directions,
                           std::span<RayHit> hits) {
  SIMVIS_ASSERT(world_ != nullptr && hits.size() == directions.size());
  if (!tree_) tree_.emplace(on_item, on_triangle);
  tree_->update(*world_, glm::dvec3(world_from_sensor[3]));
  ++casts_;
  const std::size_t threads = thread_count(directions.size());
  if (views_.size() < threads) views_.resize(threads);
  for (SensorView& view : views_) {
    view.list = world_;
    view.tree = &*tree_;
    view.world_from_sensor = world_from_sensor;
    view.cast = casts_;
    view.seen.resize(tree_->items().size());
  }
  const std::size_t share = (directions.size() + threads - 1) / threads;
  const auto cast_share = [&](std::size_t thread) {
    const std::size_t first = std::min(thread * share, directions.size());
    const std::size_t count = std::min(share, directions.size() - first);
    cast_all(views_[thread], directions.subspan(first, count), hits.subspan(first, count));
  };
  std::vector<std::jthread> others;
  for (std::size_t thread = 1; thread < threads; ++thread) others.emplace_back(cast_share, thread);
  cast_share(0);
  others.clear();  // waits for them
  rays_ += directions.size();
}

RayCounters EmbreeRayCaster::counters() const {
  if (!tree_) return {};
  RayCounters counters = tree_->counters();
  counters.rays = rays_;
  for (const SensorView& view : views_) {
    counters.item_tests += view.item_tests;
    counters.triangle_tests += view.triangle_tests;
  }
  return counters;
}

}  // namespace

bool has_host_ray_caster() { return true; }
std::unique_ptr<RayCaster> make_host_ray_caster() { return std::make_unique<EmbreeRayCaster>(); }

}  // namespace simvis
