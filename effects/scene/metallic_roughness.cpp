// How surfaces reflect light: glTF's metallic-roughness model with its maps.
//
// Lights are reflected as glTF 2.0, appendix B, has it: the microfacets of Trowbridge and Reitz (GGX), Smith's
// visibility, Schlick's Fresnel term, and beneath them, where it is no metal, Lambert's surface. The share of metal and
// the roughness are factors times a map.
//
// Ambient light has the same radiance L from all around. What a surface makes of it is L times its albedo: of a metal
// the base colour, which is its reflectance at normal incidence; of a dielectric the base colour too, since what its
// boundary reflects does not get below it. So ambient light shows base colour x L, whatever the share of metal and the
// roughness: a white surface disappears in a white furnace. Left out is that surfaces turn brighter at grazing angles,
// and of coloured metals that light which is reflected several times takes on more colour. An occlusion map says how
// much of the ambient light arrives; it does not change that of lights.
#include <algorithm>

#include <simvis/effect.h>

namespace simvis {
namespace {

bool is_called_for(const DrawItem& item, const DrawList& list) {
  const Material& m = *list.materials[item.material];
  if (m.unlit) return false;
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
