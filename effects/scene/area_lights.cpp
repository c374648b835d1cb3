// The effect `area_lights`: lamps with a size, and the sky as a lamp. What they are made of: elements/lamp.h and
// elements/sky_light.h.
#include <algorithm>
#include <string>

#include <simvis/draw_list.h>
#include <simvis/effect.h>

namespace simvis {
namespace {

void plan_area_lights(const DrawList& list, const TargetLimits&, FramePlan& plan) {
  const auto points =
      std::ranges::count_if(list.lights, [](const LightItem& item) { return item.light.lamp_points > 1; });
  if (points == 0) return;
  for (const Pass& pass : plan.passes) {
    if (pass.color)
      plan.effects.push_back({pass.name, "area_lights", "points of lamps and skies: " + std::to_string(points)});
  }
}

const EffectRegistration kAreaLightsRegistration({
    .name = "area_lights",
    .summary = "Lamps with a size, and the sky, light from many points and throw soft shadows.",
    .notes =
        "A point or spot light with a radius is a ball whose surface shines, a directional light with an "
        "angular_radius a disc in the sky, and a sky_light all of the sky. Each consists of lights that share its "
        "intensity, each with shadows of its own if the lamp has shadows. A view takes at most 256 lights, 64 of them "
        "with shadows.",
    .source = "a light element with a radius or angular_radius above 0, or a sky_light element",
    .outputs = kShownInColor,
    .knob = "lamp_points",
    .reference =
        "the share of the lamp that a point sees: of a ball beyond a straight edge linear in the edge's place, of a "
        "disc its segment",
    .plan_frame = plan_area_lights,
});

}  // namespace
}  // namespace simvis
