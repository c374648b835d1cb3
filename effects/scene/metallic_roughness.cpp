// The effect `metallic_roughness`: surfaces reflect light by glTF's metallic-roughness model with its maps.
//
// Lights are reflected as glTF 2.0, appendix B, defines: Trowbridge-Reitz (GGX) microfacets, Smith's visibility,
// Schlick's Fresnel term and, below them for non-metals, a Lambertian surface. Metalness and roughness are factors
// times a map.
//
// Ambient light has the same radiance L from all directions. A surface reflects L times its albedo. For a metal the
// albedo is the base colour, which is its reflectance at normal incidence; for a dielectric it is the base colour as
// well, since light that the boundary reflects does not reach the layer below. Ambient light therefore shows base
// colour x L for any metalness and roughness: a white surface disappears in a white furnace. The model leaves out that
// surfaces become brighter at grazing angles, and that light takes on more colour when coloured metals reflect it
// several times. An occlusion map gives the share of ambient light that arrives; it does not affect lights.
#include <algorithm>

#include <simvis/effect.h>

namespace simvis {
namespace {

bool is_called_for(const DrawItem& item, const DrawList& list) {
  const Material& m = *list.materials[item.material];
  if (!item.visible || m.unlit) return false;
  const auto has = [&](MapKind kind) { return m.map(kind).texture != nullptr; };
  const bool reflects = m.metallic > 0 || m.roughness < 1 || has(MapKind::metallic_roughness);
  return (reflects && !list.lights.empty()) || (has(MapKind::occlusion) && m.occlusion_strength > 0) ||
         (has(MapKind::emissive) && m.emissive != glm::vec3(0));
}

bool metallic_roughness_in_scene(const DrawList& list) {
  return std::ranges::any_of(list.items, [&](const DrawItem& item) { return is_called_for(item, list); });
}

const EffectRegistration kMetallicRoughnessRegistration({
    .name = "metallic_roughness",
    .summary = "Surfaces reflect light like metals and like smooth or rough dielectrics.",
    .notes = "The formulas are those of glTF 2.0, appendix B, with metallic-roughness, occlusion and emissive "
             "textures. A material whose file gives neither metalness nor roughness is matte. Ambient light shows base "
             "colour times ambient light on metal as well.",
    .source = "a material that is metallic or smoother than 1, or has a texture of that, of occlusion or of emission",
    .outputs = kShownInColor,
    .reference = "the formulas of glTF 2.0, appendix B; a white furnace",
    .in_scene = metallic_roughness_in_scene,
});

}  // namespace
}  // namespace simvis
