// One depth target for the strips of all due sensors: one render pass.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "engine/frame_plan.h"
#include "engine/renderer.h"

namespace simvis {

/// Where a view's pixels will lie.
struct AtlasPlace {
  std::size_t pass = 0;
  std::uint32_t x_px = 0, y_px = 0;
};

/// The atlas that all sensors share.
inline constexpr std::string_view kDepthAtlas = "depth atlas";

/// Puts a view (its size set, its place not) below those that the plan's atlas of this name already has.
AtlasPlace place_in_depth_atlas(FramePlan& plan, View view, std::string_view atlas = kDepthAtlas);

}  // namespace simvis
