// The depth atlas: one depth target and one render pass for all faces of a sensor.
//
// A rasteriser counts pixels from the corner of its target and rounds pixel coordinates: the last bits of a view depend
// on its position in the target. Sensors therefore do not share a target, so that the measurement of one sensor does
// not change with the others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include <simvis/frame_plan.h>
#include <simvis/frame_results.h>

namespace simvis {

/// The position of a view's pixels in the plan.
struct AtlasPlace {
  std::size_t pass = 0, view = 0;
  std::uint32_t x_px = 0, y_px = 0;
};

/// Places a view (with its size set and its position not) below the views that the plan's depth atlas of this sensor
/// already has.
AtlasPlace place_in_depth_atlas(FramePlan& plan, const std::string& sensor, View view);

}  // namespace simvis
