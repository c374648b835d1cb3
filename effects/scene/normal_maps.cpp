// The effect `normal_maps`: normal maps show relief that the mesh does not have by changing the shading.
//
// glTF 2.0, section 3.9.3: rgb from 0 to 1 is a vector from -1 to 1, with x and y times the material's scale, along the
// directions in which u grows and v falls, and outwards. The directions are computed from the derivatives of position
// and texture coordinates in the image (Schueler, Normal Mapping without Precomputed Tangents, ShaderX5, 2006), not
// from the TANGENT attribute of the file. On flat triangles both are the same, also with mirrored coordinates, and no
// vertex of any mesh has to carry tangents. Where tangents differ between the corners of a triangle, the file's
// tangents would be interpolated. Only lights show normals: a scene without lights uploads no normal map.
#include <algorithm>

#include <simvis/effect.h>

namespace simvis {
namespace {

bool is_relief(const DrawItem& item, const DrawList& list) {
  const Material& material = *list.materials[item.material];
  return item.visible && !material.unlit && material.normal_scale != 0 &&
         material.map(MapKind::normal).texture != nullptr;
}

bool normal_maps_in_scene(const DrawList& list) {
  return !list.lights.empty() &&
         std::ranges::any_of(list.items, [&](const DrawItem& item) { return is_relief(item, list); });
}

const EffectRegistration kNormalMapsRegistration({
    .name = "normal_maps",
    .summary = "Light falls on a surface as on the relief that a glTF normal texture describes.",
    .notes = "The tangent frame follows the texture coordinates in the picture, mirrored ones included. The attribute "
             "TANGENT is not read.",
    .source = "a lit material with a normal texture",
    .outputs = kShownInColor,
    .reference = "a surface that is really tilted; glTF 2.0, section 3.9.3",
    .in_scene = normal_maps_in_scene,
});

}  // namespace
}  // namespace simvis
