#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <optional>
#include <utility>

#include "engine/assert.h"
#include "engine/embree_items.h"
#include "engine/nearest_hit.h"
#include "engine/ray_caster.h"

namespace simvis {

namespace {

// Rays that travel together: as many as most machines take at a time. Those of a scan are not so coherent that
// Embree's traversal for that would pay.
constexpr unsigned kLanes = 8;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Up to 8 rays on their way. Embree hands the context back to the callbacks: it has to stand first.
struct Packet {
  RTCIntersectContext context;
  RayView* view;
  glm::dvec3 direction[kLanes];
  ShearedRay ray[kLanes];
  NearestHit nearest[kLanes];
  std::uint64_t item_tests, triangle_tests;
  // Of the item that is being walked: its rays in its unit frame, which begin at start_m.
  std::uint32_t placed;
  double start_m[kLanes];
  RTCRayHit8 local;
};
static_assert(std::is_standard_layout_v<Packet>);

void on_triangle(const RTCIntersectFunctionNArguments* arguments) {
  Packet& packet = *reinterpret_cast<Packet*>(arguments->context);
  RTCRayN* const rays = RTCRayHitN_RayN(arguments->rayhit, arguments->N);
  const EmbreeMesh& tree = *static_cast<const EmbreeMesh*>(arguments->geometryUserPtr);
  const SeenItem& item = packet.view->seen(packet.placed);
  const std::array<glm::dvec3, 3> corners = place_corners(*tree.mesh(), arguments->primID, item.placement);
  for (unsigned i = 0; i < arguments->N; ++i) {
    if (arguments->valid[i] != -1) continue;
    const unsigned lane = RTCRayN_id(rays, arguments->N, i);
    const double before_m = packet.nearest[lane].range_m;
    ++packet.triangle_tests;
    packet.view->try_triangle(packet.ray[lane], packet.placed, arguments->primID, corners, packet.nearest[lane]);
    const double range_m = packet.nearest[lane].range_m;
    if (range_m < before_m) {
      RTCRayN_tfar(rays, arguments->N, i) = end_of_ray((range_m - packet.start_m[lane]) * item.units_per_m);
    }
  }
}

// Sets the lane's ray in the item's unit frame: false if it does not run there before its nearest hit.
bool enter(const SeenItem& item, const RayMesh& mesh, Packet& packet, unsigned lane) {
  UnitRay ray;
  if (!enter_mesh(item, mesh, packet.direction[lane], packet.nearest[lane].range_m, ray)) return false;
  const glm::vec3 from(ray.from), unit = float_direction(ray.way);
  packet.start_m[lane] = ray.start_m;
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

void walk_one_by_one(Packet& packet, const RayMesh& mesh, const MeshPlacement& placement, unsigned lanes) {
  for (std::uint32_t t = 0; t < mesh.triangles(); ++t) {
    const std::array<glm::dvec3, 3> corners = place_corners(*mesh.mesh(), t, placement);
    for (unsigned lane = 0; lane < kLanes; ++lane) {
      if (!(lanes >> lane & 1)) continue;
      ++packet.triangle_tests;
      packet.view->try_triangle(packet.ray[lane], packet.placed, t, corners, packet.nearest[lane]);
    }
  }
}

void walk_tree(Packet& packet, const EmbreeMesh& tree, const SeenItem& item, unsigned lanes) {
  alignas(32) int valid[kLanes] = {};
  bool any = false;
  for (unsigned lane = 0; lane < kLanes; ++lane) {
    if (!(lanes >> lane & 1) || !enter(item, tree, packet, lane)) continue;
    valid[lane] = -1;
    any = true;
  }
  if (any) rtcIntersect8(valid, tree.scene(), &packet.context, &packet.local);
}

void on_item(const RTCIntersectFunctionNArguments* arguments) {
  Packet& packet = *reinterpret_cast<Packet*>(arguments->context);
  RTCRayN* const rays = RTCRayHitN_RayN(arguments->rayhit, arguments->N);
  const SeenItem& item = packet.view->seen(arguments->primID);
  packet.placed = arguments->primID;
  unsigned lanes = 0;
  for (unsigned i = 0; i < arguments->N; ++i) {
    if (arguments->valid[i] != -1) continue;
    lanes |= 1u << RTCRayN_id(rays, arguments->N, i);
    ++packet.item_tests;
  }
  const auto& tree = static_cast<const EmbreeMesh&>(*packet.view->placed(arguments->primID).mesh);
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

void cast_packet(RayView& view, RTCScene items, std::span<const glm::dvec3> directions, std::span<RayHit> hits,
                 std::span<const double> beyond_m) {
  Packet packet;
  rtcInitIntersectContext(&packet.context);
  packet.view = &view;
  packet.item_tests = packet.triangle_tests = 0;
  const glm::vec3 from(glm::dvec3(view.world_from_sensor()[3]) - view.items().origin());
  const glm::dmat3 world_from_sensor(view.world_from_sensor());
  alignas(32) int valid[kLanes] = {};
  RTCRayHit8 rays;
  clear(rays);
  clear(packet.local);
  for (unsigned lane = 0; lane < directions.size(); ++lane) {
    const glm::vec3 way = float_direction(world_from_sensor * directions[lane]);
    packet.direction[lane] = directions[lane];
    packet.ray[lane] = ShearedRay(directions[lane]);
    if (!beyond_m.empty()) packet.nearest[lane].beyond_m = beyond_m[lane];
    rays.ray.org_x[lane] = from.x;
    rays.ray.org_y[lane] = from.y;
    rays.ray.org_z[lane] = from.z;
    rays.ray.dir_x[lane] = way.x;
    rays.ray.dir_y[lane] = way.y;
    rays.ray.dir_z[lane] = way.z;
    rays.ray.tfar[lane] = end_of_ray(kInfinity);
    valid[lane] = -1;
  }
  rtcIntersect8(valid, items, &packet.context, &rays);
  for (unsigned lane = 0; lane < directions.size(); ++lane) {
    hits[lane] = view.finish(packet.ray[lane], packet.nearest[lane]);
  }
  view.item_tests += packet.item_tests;
  view.triangle_tests += packet.triangle_tests;
}

void cast_all(RayView& view, RTCScene items, std::span<const glm::dvec3> directions, std::span<RayHit> hits,
              std::span<const double> beyond_m) {
  for (std::size_t first = 0; first < directions.size(); first += kLanes) {
    const std::size_t count = std::min<std::size_t>(kLanes, directions.size() - first);
    cast_packet(view, items, directions.subspan(first, count), hits.subspan(first, count),
                part_of(beyond_m, first, count));
  }
}

// Of how many rays, from `first` on, the origins are the same.
std::size_t together(std::span<const glm::dvec3> origins_m, std::size_t first) {
  std::size_t end = first + 1;
  while (end < origins_m.size() && origins_m[end] == origins_m[first]) ++end;
  return end - first;
}

class EmbreeRayCaster : public RayCaster {
 public:
  void set_world(const DrawList& list) override { world_ = &list; }
  void cast(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> directions, std::span<RayHit> hits,
            std::span<const double> beyond_m) override;
  void cast_from(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> origins_m,
                 std::span<const glm::dvec3> directions, std::span<RayHit> hits,
                 std::span<const double> beyond_m) override;
  RayCounters counters() const override;
  bool on_host() const override { return true; }
  std::string_view engine() const override { return "Embree"; }

 private:
  using Share = std::function<void(RayView& view, std::size_t first, std::size_t count)>;
  void update(const glm::dvec3& world_place);
  void share(std::size_t rays, const Share& work);

  const DrawList* world_ = nullptr;
  std::optional<EmbreeItems> items_;  // from the first cast on
  std::vector<RayView> views_;        // of each thread
  std::uint64_t rays_ = 0;
};

void EmbreeRayCaster::cast(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> directions,
                           std::span<RayHit> hits, std::span<const double> beyond_m) {
  SIMVIS_ASSERT(world_ != nullptr && hits.size() == directions.size());
  SIMVIS_ASSERT(beyond_m.empty() || beyond_m.size() == directions.size());
  update(glm::dvec3(world_from_sensor[3]));
  share(directions.size(), [&](RayView& view, std::size_t first, std::size_t count) {
    view.begin(*world_, items_->items(), world_from_sensor);
    cast_all(view, items_->scene(), directions.subspan(first, count), hits.subspan(first, count),
             part_of(beyond_m, first, count));
  });
}

void EmbreeRayCaster::cast_from(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> origins_m,
                                std::span<const glm::dvec3> directions, std::span<RayHit> hits,
                                std::span<const double> beyond_m) {
  SIMVIS_ASSERT(beyond_m.empty() || beyond_m.size() == directions.size());
  SIMVIS_ASSERT(world_ != nullptr && hits.size() == directions.size() && origins_m.size() == directions.size());
  for (std::size_t start = 0, served = 0; start < directions.size(); start += served) {
    update(glm::dvec3(glm::translate(world_from_sensor, origins_m[start])[3]));
    served = items_->items().in_reach(world_from_sensor, origins_m.subspan(start));
    share(served, [&](RayView& view, std::size_t first, std::size_t count) {
      const std::size_t end = start + first + count;
      for (std::size_t ray = start + first, group = 0; ray < end; ray += group) {
        group = std::min(together(origins_m, ray), end - ray);
        view.begin(*world_, items_->items(), glm::translate(world_from_sensor, origins_m[ray]));
        cast_all(view, items_->scene(), directions.subspan(ray, group), hits.subspan(ray, group),
                 part_of(beyond_m, ray, group));
      }
    });
  }
}

void EmbreeRayCaster::update(const glm::dvec3& world_place) {
  if (!items_) items_.emplace(on_item, on_triangle);
  items_->update(*world_, world_place);
}

void EmbreeRayCaster::share(std::size_t rays, const Share& work) {
  const std::size_t threads = ray_threads(rays);
  if (views_.size() < threads) views_.resize(threads);
  share_rays(rays, threads,
             [&](std::size_t thread, std::size_t first, std::size_t count) { work(views_[thread], first, count); });
  rays_ += rays;
}

RayCounters EmbreeRayCaster::counters() const {
  if (!items_) return {};
  RayCounters counters = items_->items().counters;
  counters.rays = rays_;
  for (const RayView& view : views_) {
    counters.item_tests += view.item_tests;
    counters.triangle_tests += view.triangle_tests;
  }
  return counters;
}

}  // namespace

bool has_host_ray_caster() { return true; }
std::unique_ptr<RayCaster> make_host_ray_caster() { return std::make_unique<EmbreeRayCaster>(); }

}  // namespace simvis
