// The effect `transparency`: transparent surfaces are composited by depth for each sample, independent of the drawing
// order of parts and faces, see engine/render/oit_buffer.h.
#include <algorithm>

#include <simvis/effect.h>

namespace simvis {
namespace {

bool is_transparent(const Material& material) {
  return material.opacity > 0 && (material.opacity < 1 || material.alpha_mode == AlphaMode::blend);
}

bool transparency_in_scene(const DrawList& list) {
  return std::ranges::any_of(
      list.items, [&](const DrawItem& item) { return item.visible && is_transparent(*list.materials[item.material]); });
}

const EffectRegistration kTransparencyRegistration({
    .name = "transparency",
    .summary = "Surfaces behind blended and faded surfaces show through them.",
    .notes = "Layers are composited by depth, sample by sample, in whatever order parts and faces are drawn. Crossing "
             "panes are exact, and a shuffled scene file gives the same bytes. Every layer is kept, at 32 bytes each; "
             "a frame that needs more memory is drawn again with more. This effect is slow on lavapipe.",
    .source = "a part with a material that is blended, or whose opacity is below 1",
    .outputs = kShownInColor,
    .reference = "Porter and Duff 1984: over, of all surfaces of a sample by their depth",
    .in_scene = transparency_in_scene,
});

}  // namespace
}  // namespace simvis
