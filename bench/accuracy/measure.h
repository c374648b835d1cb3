// Measures times and errors of all variants of one scanner in one scene.
#pragma once

#include <string>
#include <vector>

#include "bench/accuracy/scenes.h"
#include "bench/accuracy/truth.h"
#include "bench/accuracy/variants.h"

namespace simvis::bench {

/// The results of one variant, or of bare Embree (`method` then says so).
struct Result {
  std::string method, max_error_rel{};
  int resolution_px = 0;
  std::vector<float> times_ms{};  ///< of each scan
  BeamErrors errors{};
  std::vector<float> cast_shares{};  ///< of each scan: share of its beams that was cast; NaN if none ever is
  bool peer = false;                 ///< bare Embree: has neither bounds nor masks
};

/// Measures only each `every`-th station and heading, for short runs.
///
/// Timing   of a variant: planning, rendering, casting and collecting of one scan, with results in memory, from the
///          stage times of Simulation::step(). The variants take turns; each measures a few headings after one scan
///          that does not count.
///          Of bare Embree: only its casts.
std::vector<Result> measure(Simulation& simulation, const AccuracyScene& scene, const AccuracyScanner& scanner,
                            int every);

}  // namespace simvis::bench
