// Transparent surfaces in pictures: resolved for each sample by depth, in whatever order parts and faces are drawn, see
// engine/oit_buffer.h.
#include <algorithm>

#include <simvis/effect.h>

namespace simvis {
namespace {

bool is_transparent(const Material& material) {
  return material.opacity > 0 && (material.opacity < 1 || material.alpha_mode == AlphaMode::blend);
}

bool transparency_in_scene(const DrawList& list) {
  return std::ranges::any_of(list.items,
                             [&](const DrawItem& item) { return is_transparent(*list.materials[item.material]); });
}

#define BALL \
  R"(<part file="../showcase/ball.glb" name="EFFECT_BALL" insert_at="ROOT" pose_offset="-1.5 -0.4 1 0 0 0"/>)"

const EffectRegistration kTransparencyRegistration({
    .name = "transparency",
    .summary = "what lies behind blended and faded surfaces shows through them",
    .source = "a part with a material that is blended, or whose opacity is below 1",
    .outputs = kShownInColor,
    .reference = "Porter and Duff 1984: over, of all surfaces of a sample by their depth",
    .example = {.commands = BALL R"(<element type="material" name="EFFECT" insert_at="ROOT" part="EFFECT_BALL" )"
                                 R"(opacity="0.6"/>)",
                .off_commands = BALL
                R"(<element type="material" name="EFFECT" insert_at="ROOT" part="EFFECT_BALL" opacity="1"/>)",
                .plain_commands = BALL
                R"(<element type="material" name="EFFECT" insert_at="ROOT" part="EFFECT_BALL"/>)"},
    .in_scene = transparency_in_scene,
});

}  // namespace
}  // namespace simvis
