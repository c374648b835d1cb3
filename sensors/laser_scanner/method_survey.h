// Finds the cheapest method for a scan that is exact enough, by trying all methods in one frame.
//
// The candidates are `hybrid` at several resolutions, which casts the beams whose rendered bound does not meet the
// tolerance, and `raycast`, which casts all beams. `planar` is `hybrid` with no beam to cast. All candidates meet every
// tolerance that casting meets, since no rendered range is more exact than a cast range. Only the price decides: the
// work of each candidate, counted in this frame, times the cost of that work on this device (see cost_model.h). Every
// beam is cast once: beams that are cast by the same set of resolutions form a group that is cast together, and the
// casting work of a candidate is the sum over its groups.
//
// Prices are those of a scanner that runs alone: each scanner pays shared work, such as a submission, in full.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <simvis/cost_model.h>
#include <simvis/ray_caster.h>
#include "sensors/laser_scanner/rendered_scan.h"
#include "sensors/laser_scanner/scan_tolerance.h"

namespace simvis {

/// One method and its price.
struct ScanCandidate {
  double resolution_px = 0;  ///< resolution of `hybrid`; 0: `raycast`
  std::uint64_t beams_cast = 0;
  double worst_bound_m = 0, worst_bound_rel = 0;  ///< largest bounds of all finite ranges
  CostModel work{};
  double predicted_ns = 0;
};

/// "hybrid 4096" or "raycast".
std::string to_string(const ScanCandidate& candidate);

/// add_cast() adds the work of one call of the caster without its rays; add_rays() adds the work of the rays, from the
/// caster's counters before and after the call.
void add_cast(CostModel& work, std::size_t list_items);
void add_rays(CostModel& work, const RayCounters& before, const RayCounters& after);

class MethodSurvey {
 public:
  MethodSurvey(const ScanPattern& pattern, std::span<const double> resolutions_px);

  /// Each resolution has a pass of its own, because pixel errors depend on the size of the pass.
  void plan(const std::string& scanner, const glm::dmat4& sensor_from_world, FramePlan& plan);
  /// Determines the beams that each resolution would cast.
  void collect(const FramePlan& plan, std::span<const PassResult> results, std::size_t list_items,
               const VertexRounding& rounding, const RangeLimits& limits, const ScanTolerance& tolerance,
               const ShapeRanges* shapes = nullptr);
  /// Casts every beam: directions[i] and hits[i] belong to beam order[i].
  void cast(RayCaster& rays, std::size_t list_items, const glm::dmat4& world_from_sensor,
            std::span<const std::uint32_t> order, std::span<const glm::dvec3> directions, std::span<RayHit> hits);
  /// Prices the candidates with the results of the casts and chooses the cheapest; of equal ones the first.
  void choose(std::span<const BeamReading> cast, const CostModel& cost);

  std::span<const ScanCandidate> candidates() const { return candidates_; }
  std::size_t chosen() const { return chosen_; }
  /// Moves the rendered scan of the chosen resolution out of the survey; null if `raycast` was chosen.
  std::unique_ptr<RenderedScan> release_rendered();

 private:
  std::vector<std::unique_ptr<RenderedScan>> rendered_;
  std::vector<ScanCandidate> candidates_;  // one for each element of rendered_, then raycast
  std::vector<std::uint32_t> casts_of_;    // by beam: bit i is set if candidate i would cast it
  std::size_t chosen_ = 0;
};

}  // namespace simvis
