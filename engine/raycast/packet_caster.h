// Casts rays on the host's cores, in bundles.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include <simvis/ray_caster.h>
#include "engine/base/worker_threads.h"
#include "engine/geometry/wide_bvh.h"
#include "engine/raycast/closest_hit.h"

namespace simvis {

/// What is cast into: all of it up to date, for sensors at the places in question.
struct RayWorld {
  const DrawList& list;
  const RayInstances& items;
  const WideBvh& tree;  ///< over the items
};

/// One thread at a time; each call uses all cores for many rays.
class PacketCaster {
 public:
  using Work = std::function<void(RayView& view, std::size_t first, std::size_t count)>;

  /// As RayCaster::cast().
  void cast(const RayWorld& world, const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> directions,
            std::span<RayHit> hits, std::span<const double> t_min_m, const HitsReady& there);

  /// As RayCaster::cast_from(), from places that the world serves.
  void cast_from(const RayWorld& world, const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> origins_m,
                 std::span<const glm::dvec3> directions, std::span<RayHit> hits, std::span<const double> t_min_m);

  /// Has this done for all rays of a sensor, piece by piece.
  void share(const RayWorld& world, const glm::dmat4& world_from_sensor, std::size_t rays, const Work& work);

  /// Adds what only those who walk know.
  void count(RayCounters& counters) const;

 private:
  void share(std::size_t rays, const Work& work);

  std::vector<RayView> views_ = std::vector<RayView>(WorkerThreads::count());  // of each thread
  WorkerThreads threads_;
};

}  // namespace simvis
