// Which way of measuring a scan is the cheapest that is exact enough, found by trying all of them in one frame.
//
// The ways are `hybrid` at several resolutions, which casts the beams whose rendered bound does not meet the tolerance,
// and `raycast`, which casts all. `planar` is `hybrid` with no beam to cast. All of them meet every tolerance that
// casting meets, since no rendered range is more exact than a cast one; so what is left to choose by is the price:
// what each takes, counted in this frame, times what that costs on this device (see cost_model.h). Every beam is cast
// once: the beams that the same resolutions would cast go together, and a way's casts are the sum of its groups.
//
// Prices are those of a scanner that is alone: what several share, such as a submission, each pays in full.
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

/// One way to measure, and its price.
struct ScanCandidate {
  double resolution_px = 0;  ///< of `hybrid`; 0: `raycast`
  std::uint64_t beams_cast = 0;
  double worst_bound_m = 0, worst_bound_rel = 0;  ///< of all finite ranges
  CostModel work{};
  double predicted_ns = 0;
};

/// "hybrid 4096" or "raycast".
std::string to_string(const ScanCandidate& candidate);

/// The work of a call of the caster, without its rays; and that of its rays, from two looks at its counters.
void add_cast(CostModel& work, std::size_t list_items);
void add_rays(CostModel& work, const RayCounters& before, const RayCounters& after);

class MethodSurvey {
 public:
  MethodSurvey(const ScanPattern& pattern, std::span<const double> resolutions_px);

  /// Each resolution has a pass of its own: pixels err by the size of their pass, too.
  void plan(const std::string& scanner, const glm::dmat4& sensor_from_world, FramePlan& plan);
  /// Finds out which beams each resolution would cast.
  void collect(const FramePlan& plan, std::span<const PassResult> results, std::size_t list_items,
               const VertexRounding& rounding, const RangeLimits& limits, const ScanTolerance& tolerance);
  /// Casts every beam: hits[i] belongs to directions[i].
  void cast(RayCaster& rays, std::size_t list_items, const glm::dmat4& world_from_sensor,
            std::span<const glm::dvec3> directions, std::span<RayHit> hits);
  /// Prices them with what was cast; the cheapest is chosen, of several the first.
  void choose(std::span<const Reading> cast, const CostModel& cost);

  std::span<const ScanCandidate> candidates() const { return candidates_; }
  std::size_t chosen() const { return chosen_; }
  /// Of the chosen resolution; null where `raycast` was chosen. Leaves the survey without it.
  std::unique_ptr<RenderedScan> release_rendered();

 private:
  std::vector<std::unique_ptr<RenderedScan>> rendered_;
  std::vector<ScanCandidate> candidates_;  // those of rendered_, then raycast
  std::vector<std::uint32_t> casts_of_;    // of each beam: bit i is set if candidate i would cast it
  std::size_t chosen_ = 0;
};

}  // namespace simvis
