// What a scanner measures in one frame and what the frame costs, to compare worlds.
#pragma once

#include <cstddef>
#include <vector>

#include <simvis/simulation.h>
#include "tests/support/element_scene.h"

namespace simvis::test {

struct ScanFrame {
  std::vector<float> range_m, error_bound_m;
  FrameCounters counters;
  RayCounters rays;
  std::size_t casts, effects;

  bool operator==(const ScanFrame&) const = default;
};

/// The next frame of the scanner SCAN.
inline ScanFrame frame_of(World& world) {
  world->step();
  const Scan& scan = world->scan("SCAN");
  return {scan.range_m,
          scan.error_bound_m,
          world->diagnostics().counters(),
          world->diagnostics().ray_counters(),
          world->diagnostics().frame_plan().casts.size(),
          world->diagnostics().frame_plan().effects.size()};
}

}  // namespace simvis::test
