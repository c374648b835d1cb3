// Times and errors of all variants of one scanner in one scene.
#pragma once

#include <string>
#include <vector>

#include "bench/accuracy/scenes.h"
#include "bench/accuracy/truth.h"
#include "bench/accuracy/variants.h"

namespace simvis::bench {

/// One variant's results, or those of bare Embree (`method` then says so).
struct Result {
  std::string method, max_error_rel{};
  int resolution_px = 0;
  std::vector<float> times_ms{};  ///< of each scan
  BeamErrors errors{};
  std::vector<float> cast_shares{};  ///< of each scan: which part of its beams was cast; NaN where none ever is
  bool peer = false;                 ///< bare Embree: neither bounds nor masks
};

/// Only each `every`-th station and heading: for short runs.
///
/// Timing   of a variant: planning, rendering, casting and collecting of one scan, results in memory, by the stages of
///          Simulation::step(). The variants take turns, each for a few headings after one scan that does not count.
///          Of bare Embree: its casts alone.
std::vector<Result> measure(Simulation& simulation, const AccuracyScene& scene, const AccuracyScanner& scanner,
                            int every);

}  // namespace simvis::bench
