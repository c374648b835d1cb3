#include "sensors/raster_depth/depth_atlas.h"

#include <algorithm>
#include <utility>

namespace simvis {

namespace {

// Every Vulkan device with 4096-pixel targets or larger supports this height; a taller atlas continues in the next
// pass.
constexpr std::uint32_t kMaxHeight = 4096;

}  // namespace

AtlasPlace place_in_depth_atlas(FramePlan& plan, const std::string& sensor, View view) {
  const std::string name = sensor + ".depth";  // sensor names contain no point, so no camera's pass has this name
  auto pass = std::ranges::find_if(
      plan.passes, [&](const Pass& p) { return p.name == name && p.height_px + view.height_px <= kMaxHeight; });
  if (pass == plan.passes.end()) {
    plan.passes.push_back({.name = name, .width_px = 0, .height_px = 0, .color = false, .depth = true, .views = {}});
    pass = std::prev(plan.passes.end());
  }
  view.x_px = 0;
  view.y_px = pass->height_px;
  pass->width_px = std::max(pass->width_px, view.width_px);
  pass->height_px += view.height_px;
  const AtlasPlace place{static_cast<std::size_t>(pass - plan.passes.begin()), pass->views.size(), view.x_px,
                         view.y_px};
  pass->views.push_back(std::move(view));
  return place;
}

}  // namespace simvis
