// One depth target for all strips of a sensor: one render pass.
//
// A rasteriser counts pixels from the corner of its target, and rounds as it does: what a view shows depends, in its
// last bits, on where it lies there. So sensors do not share a target: what one measures would change with the others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include <simvis/frame_plan.h>
#include <simvis/frame_results.h>

namespace simvis {

/// Where a view's pixels will lie.
struct AtlasPlace {
  std::size_t pass = 0, view = 0;
  std::uint32_t x_px = 0, y_px = 0;
};

/// Puts a view (its size set, its place not) below those that the plan's depth atlas of this sensor already has.
AtlasPlace place_in_depth_atlas(FramePlan& plan, const std::string& sensor, View view);

}  // namespace simvis
