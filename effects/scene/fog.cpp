// The effect `fog`: fog and haze in images. Each surface, also a transparent one, fades over its range along the ray as
// shaders/fog.glsl defines, and the background as if it were infinitely far away. Depth does not change. The effect
// `atmosphere` models the air for lasers.
#include <simvis/effect.h>

namespace simvis {
namespace {

bool fog_in_scene(const DrawList& list) { return list.medium.extinction_per_m > 0; }

const EffectRegistration kFogRegistration({
    .name = "fog",
    .summary = "Surfaces fade into the airlight with distance.",
    .notes =
        "A surface at the distance d along its ray has the radiance x t + airlight (1 - t), where t = exp(-extinction "
        "d). The contrast at the visibility is 0.02. The background is the airlight. Depth does not change.",
    .source = "air that weakens visible light: element fog",
    .outputs = kShownInColor,
    .reference = "Koschmieder 1924: radiance = surface x t + airlight x (1 - t), t = exp(-extinction x distance)",
    .in_scene = fog_in_scene,
});

}  // namespace
}  // namespace simvis
