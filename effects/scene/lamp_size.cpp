// The effect `lamp_size`: lights that are lamps with a size. What a lamp is made of: elements/lamp.h.
#include <algorithm>
#include <string>

#include <simvis/draw_list.h>
#include <simvis/effect.h>

namespace simvis {
namespace {

void plan_lamp_size(const DrawList& list, const TargetLimits&, FramePlan& plan) {
  const auto points =
      std::ranges::count_if(list.lights, [](const LightItem& item) { return item.light.lamp_points > 1; });
  if (points == 0) return;
  for (const Pass& pass : plan.passes) {
    if (pass.color) plan.effects.push_back({pass.name, "lamp_size", "points of lamps: " + std::to_string(points)});
  }
}

const EffectRegistration kLampSizeRegistration({
    .name = "lamp_size",
    .summary = "Lamps with a size light from many points, and throw soft shadows.",
    .notes =
        "A point or spot light with a radius is a ball whose surface shines, a directional light with an "
        "angular_radius a disc in the sky. Both are lamp_points lights that share the intensity, each with shadows of "
        "its own if the lamp has shadows. A view takes at most 256 lights, 64 of them with shadows.",
    .source = "a light element with a radius or angular_radius above 0",
    .outputs = kShownInColor,
    .knob = "lamp_points",
    .reference =
        "the share of the lamp that a point sees: of a ball beyond a straight edge linear in the edge's place, of a "
        "disc its segment",
    .plan_frame = plan_lamp_size,
});

}  // namespace
}  // namespace simvis
