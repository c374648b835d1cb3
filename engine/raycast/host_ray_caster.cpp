// Casts rays on the host's cores.
#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <vector>

#include <simvis/ray_caster.h>
#include "engine/base/assert.h"
#include "engine/raycast/item_tree.h"
#include "engine/raycast/packet_caster.h"

namespace simvis {

namespace {

class HostRayCaster : public RayCaster {
 public:
  HostRayCaster(const std::filesystem::path& cache, const std::shared_ptr<ThreadPool>& pool)
      : items_(cache, pool), packet_caster_(pool) {}
  void set_world(const DrawList& list) override {
    list_ = &list;
    ignored_.clear();
    current_ = false;
  }
  void ignore(std::span<const std::uint32_t> items) override {
    if (std::ranges::equal(items, ignored_)) return;
    ignored_.assign(items.begin(), items.end());
    current_ = false;
  }
  void cast(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> directions, std::span<RayHit> hits,
            std::span<const double> t_min_m, const HitsReady& there, HitSides sides) override;
  void cast_from(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> origins_m,
                 std::span<const glm::dvec3> directions, std::span<RayHit> hits,
                 std::span<const double> t_min_m) override;
  void parallel_for(std::size_t count, std::size_t piece, const LoopBody& body) override {
    items_.threads().parallel_for(count, piece, body);
  }
  unsigned threads() const override { return items_.threads().size(); }
  RayCounters counters() const override;
  bool on_host() const override { return true; }
  std::string_view engine() const override { return "the host"; }

 private:
  void update(const glm::dvec3& world_place);
  RayWorld world(HitSides sides) const { return {*list_, items_, tree_.tree(), sides}; }

  const DrawList* list_ = nullptr;
  std::vector<std::uint32_t> ignored_;  // items of the list
  bool current_ = false;                // whether the trees are up to date with both
  RayInstances items_;
  ItemTree tree_;
  PacketCaster packet_caster_;
};

void HostRayCaster::cast(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> directions,
                         std::span<RayHit> hits, std::span<const double> t_min_m, const HitsReady& there,
                         HitSides sides) {
  SIMVIS_ASSERT(list_ != nullptr && hits.size() == directions.size());
  SIMVIS_ASSERT(t_min_m.empty() || t_min_m.size() == directions.size());
  update(glm::dvec3(world_from_sensor[3]));
  packet_caster_.cast(world(sides), world_from_sensor, directions, hits, t_min_m, there);
  items_.counters.rays += directions.size();
}

void HostRayCaster::cast_from(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> origins_m,
                              std::span<const glm::dvec3> directions, std::span<RayHit> hits,
                              std::span<const double> t_min_m) {
  SIMVIS_ASSERT(t_min_m.empty() || t_min_m.size() == directions.size());
  SIMVIS_ASSERT(list_ != nullptr && hits.size() == directions.size() && origins_m.size() == directions.size());
  for (std::size_t start = 0, served = 0; start < directions.size(); start += served) {
    update(glm::dvec3(glm::translate(world_from_sensor, origins_m[start])[3]));
    served = items_.in_reach(world_from_sensor, origins_m.subspan(start));
    packet_caster_.cast_from(world(HitSides::both), world_from_sensor, origins_m.subspan(start, served),
                             directions.subspan(start, served), hits.subspan(start, served),
                             part_of(t_min_m, start, served));
  }
  items_.counters.rays += directions.size();
}

void HostRayCaster::update(const glm::dvec3& world_place) {
  if (current_ && items_.reaches(world_place)) return;
  current_ = false;
  items_.update(*list_, ignored_, world_place);
  const ItemTree::Change change = tree_.update(items_);
  items_.counters.item_trees_refitted += change == ItemTree::Change::fitted;
  items_.counters.item_trees_built += change == ItemTree::Change::built;
  current_ = true;
}

RayCounters HostRayCaster::counters() const {
  RayCounters counters = items_.counters;
  packet_caster_.count(counters);
  return counters;
}

}  // namespace

std::unique_ptr<RayCaster> make_host_ray_caster(const std::filesystem::path& cache, unsigned threads) {
  return std::make_unique<HostRayCaster>(cache, shared_thread_pool(threads));
}

}  // namespace simvis
