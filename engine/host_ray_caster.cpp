// Casts rays on the host's cores, in bundles.
#include <algorithm>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <vector>

#include "engine/assert.h"
#include "engine/bundle_walk.h"
#include "engine/item_tree.h"
#include "engine/ray_caster.h"
#include "engine/worker_threads.h"

namespace simvis {

namespace {

// What takes several times as long as to wake a thread: a planar scan is cast by one.
constexpr std::size_t kPiece = 16 * std::size_t{RayBundle::kMost};

// Of how many rays, from `first` on, the origins are the same.
std::size_t together(std::span<const glm::dvec3> origins_m, std::size_t first) {
  std::size_t end = first + 1;
  while (end < origins_m.size() && origins_m[end] == origins_m[first]) ++end;
  return end - first;
}

class HostRayCaster : public RayCaster {
 public:
  void set_world(const DrawList& list) override {
    list_ = &list;
    current_ = false;
  }
  void cast(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> directions, std::span<RayHit> hits,
            std::span<const double> beyond_m) override;
  void cast_from(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> origins_m,
                 std::span<const glm::dvec3> directions, std::span<RayHit> hits,
                 std::span<const double> beyond_m) override;
  RayCounters counters() const override;
  bool on_host() const override { return true; }
  std::string_view engine() const override { return "the host"; }

 private:
  using Share = std::function<void(RayView& view, std::size_t first, std::size_t count)>;
  void update(const glm::dvec3& world_place);
  void share(std::size_t rays, const Share& work);
  void cast_bundles(RayView& view, std::span<const glm::dvec3> directions, std::span<RayHit> hits,
                    std::span<const double> beyond_m) const;

  const DrawList* list_ = nullptr;
  bool current_ = false;  // whether the trees are those of the list
  RayItems items_;
  ItemTree tree_;
  std::vector<RayView> views_ = std::vector<RayView>(WorkerThreads::count());  // of each thread
  std::uint64_t rays_ = 0;
  WorkerThreads threads_;
};

void HostRayCaster::cast(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> directions,
                         std::span<RayHit> hits, std::span<const double> beyond_m) {
  SIMVIS_ASSERT(list_ != nullptr && hits.size() == directions.size());
  SIMVIS_ASSERT(beyond_m.empty() || beyond_m.size() == directions.size());
  update(glm::dvec3(world_from_sensor[3]));
  for (RayView& view : views_) view.begin(*list_, items_, world_from_sensor);
  share(directions.size(), [&](RayView& view, std::size_t first, std::size_t count) {
    cast_bundles(view, directions.subspan(first, count), hits.subspan(first, count), part_of(beyond_m, first, count));
  });
}

void HostRayCaster::cast_from(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> origins_m,
                              std::span<const glm::dvec3> directions, std::span<RayHit> hits,
                              std::span<const double> beyond_m) {
  SIMVIS_ASSERT(beyond_m.empty() || beyond_m.size() == directions.size());
  SIMVIS_ASSERT(list_ != nullptr && hits.size() == directions.size() && origins_m.size() == directions.size());
  for (std::size_t start = 0, served = 0; start < directions.size(); start += served) {
    update(glm::dvec3(glm::translate(world_from_sensor, origins_m[start])[3]));
    served = items_.in_reach(world_from_sensor, origins_m.subspan(start));
    share(served, [&](RayView& view, std::size_t first, std::size_t count) {
      const std::size_t end = start + first + count;
      for (std::size_t ray = start + first, group = 0; ray < end; ray += group) {
        group = std::min(together(origins_m, ray), end - ray);
        view.begin(*list_, items_, glm::translate(world_from_sensor, origins_m[ray]));
        cast_bundles(view, directions.subspan(ray, group), hits.subspan(ray, group), part_of(beyond_m, ray, group));
      }
    });
  }
}

void HostRayCaster::cast_bundles(RayView& view, std::span<const glm::dvec3> directions, std::span<RayHit> hits,
                                 std::span<const double> beyond_m) const {
  for (std::size_t first = 0; first < directions.size();) {
    const std::size_t left = directions.size() - first;
    RayBundle bundle(directions.subspan(first), part_of(beyond_m, first, left));
    walk_bundle(view, tree_.tree(), bundle);
    finish_bundle(view, bundle, hits.data() + first);
    first += bundle.count;
  }
}

void HostRayCaster::update(const glm::dvec3& world_place) {
  if (current_ && items_.reaches(world_place)) return;
  current_ = false;
  items_.update(*list_, world_place);
  const ItemTree::Change change = tree_.update(items_);
  items_.counters.item_trees_refitted += change == ItemTree::Change::fitted;
  items_.counters.item_trees_built += change == ItemTree::Change::built;
  current_ = true;
}

void HostRayCaster::share(std::size_t rays, const Share& work) {
  threads_.share(rays, kPiece,
                 [&](std::size_t thread, std::size_t first, std::size_t count) { work(views_[thread], first, count); });
  rays_ += rays;
}

RayCounters HostRayCaster::counters() const {
  RayCounters counters = items_.counters;
  counters.rays = rays_;
  for (const RayView& view : views_) {
    counters.item_tests += view.item_tests;
    counters.triangle_tests += view.triangle_tests;
  }
  return counters;
}

}  // namespace

std::unique_ptr<RayCaster> make_host_ray_caster() { return std::make_unique<HostRayCaster>(); }

}  // namespace simvis
