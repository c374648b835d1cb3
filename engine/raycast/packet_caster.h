// Casts rays on the host's cores, in packets.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <simvis/ray_caster.h>
#include "engine/base/thread_pool.h"
#include "engine/geometry/wide_bvh.h"
#include "engine/raycast/closest_hit.h"

namespace simvis {

/// The world that rays are cast into. All parts are up to date and serve sensors at the positions of the cast.
struct RayWorld {
  const DrawList& list;
  const RayInstances& items;
  const WideBvh& tree;  ///< over the items
  HitSides sides = HitSides::both;
};

/// One thread at a time may call it. A call with many rays uses all threads of the pool.
class PacketCaster {
 public:
  using Work = std::function<void(RayView& view, std::size_t first, std::size_t count)>;

  explicit PacketCaster(std::shared_ptr<ThreadPool> pool) : pool_(std::move(pool)), views_(pool_->size()) {}

  /// As RayCaster::cast().
  void cast(const RayWorld& world, const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> directions,
            std::span<RayHit> hits, std::span<const double> t_min_m, const HitsReady& there);

  /// As RayCaster::cast_from(). All origins must be in reach, see RayInstances::in_reach().
  void cast_from(const RayWorld& world, const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> origins_m,
                 std::span<const glm::dvec3> directions, std::span<RayHit> hits, std::span<const double> t_min_m);

  /// Calls `work` for all rays of a sensor, piece by piece, on the threads of the pool.
  void share(const RayWorld& world, const glm::dmat4& world_from_sensor, std::size_t rays, const Work& work);

  /// Adds the tests of all threads.
  void count(RayCounters& counters) const;

 private:
  void share(std::size_t rays, const Work& work);

  std::shared_ptr<ThreadPool> pool_;
  std::vector<RayView> views_;  // one for each thread
};

}  // namespace simvis
