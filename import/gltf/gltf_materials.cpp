#include "import/gltf/gltf_materials.h"

#include <cmath>
#include <limits>
#include <string>

#include <simvis/attributes.h>

namespace simvis {
namespace {

double number_or(const tinygltf::Value& object, const std::string& name, double otherwise) {
  return object.IsObject() && object.Has(name) ? object.Get(name).GetNumberAsDouble() : otherwise;
}

double extension_number_or(const tinygltf::Material& source, const char* extension, const char* name,
                           double otherwise) {
  const auto found = source.extensions.find(extension);
  return found == source.extensions.end() ? otherwise : number_or(found->second, name, otherwise);
}

double element_or(const tinygltf::Value& object, const std::string& name, int index, double otherwise) {
  return object.IsObject() && object.Has(name) ? object.Get(name).Get(index).GetNumberAsDouble() : otherwise;
}

AlphaMode alpha_mode_of(const std::string& mode, const std::string& place, const GltfDocument& document) {
  if (mode == "OPAQUE") return AlphaMode::opaque;
  if (mode == "MASK") return AlphaMode::mask;
  if (mode == "BLEND") return AlphaMode::blend;
  document.fail(place + "/alphaMode is \"" + mode + "\"; expected OPAQUE, MASK or BLEND");
}

// KHR_texture_transform: offset * rotation * scale. The rotation is counter-clockwise as seen in the picture, whose v
// points down.
glm::mat3x2 uv_transform_of(const tinygltf::Value& transform) {
  const double angle_rad = number_or(transform, "rotation", 0);
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  const double scale_u = element_or(transform, "scale", 0, 1), scale_v = element_or(transform, "scale", 1, 1);
  const glm::dmat3x2 matrix(c * scale_u, -s * scale_u, s * scale_v, c * scale_v, element_or(transform, "offset", 0, 0),
                            element_or(transform, "offset", 1, 0));
  return glm::mat3x2(matrix);
}

// KHR_materials_ior: the index is at least 1. The value 0 means an infinite index, which reflects all light.
float refractive_index_of(const tinygltf::Material& source, const std::string& place, const GltfDocument& document) {
  constexpr double kEndless = 1e6;
  const double ior = extension_number_or(source, "KHR_materials_ior", "ior", Material{}.refractive_index);
  if (ior == 0) return static_cast<float>(kEndless);
  if (ior >= 1 && ior <= kEndless) return static_cast<float>(ior);
  document.fail(place + "/extensions/KHR_materials_ior/ior is " + format_number(ior) + "; expected 0, or 1 to 1e6");
}

// Each factor is finite as float32, but the product need not be.
float product(double factor, double strength, const std::string& place, const GltfDocument& document) {
  const double value = factor * strength;
  if (value > std::numeric_limits<float>::max()) document.fail(place + " has an emission that is not finite");
  return static_cast<float>(value);
}

}  // namespace

NodePtr GltfMaterials::get(int material, bool shaded) {
  const auto known = nodes_.find({material, shaded});
  if (known != nodes_.end()) return known->second;
  Material converted = material < 0 ? Material{} : convert(material);
  // An unlit material needs only one node.
  if (converted.unlit && !shaded) return get(material, true);
  converted.unlit = converted.unlit || !shaded;
  auto node = std::make_shared<MaterialNode>(pool_.intern(std::move(converted)));
  if (material >= 0) node->name = document_.model.materials[static_cast<std::size_t>(material)].name;
  nodes_.emplace(std::pair(material, shaded), node);
  return node;
}

Material GltfMaterials::convert(int index) {
  const std::string place = "materials/" + std::to_string(index);
  const tinygltf::Material& source = document_.model.materials[static_cast<std::size_t>(index)];
  Material material;
  material.name = source.name;
  for (int i = 0; i < 4; ++i) {
    material.base_color[i] =
        static_cast<float>(source.pbrMetallicRoughness.baseColorFactor[static_cast<std::size_t>(i)]);
  }
  material.alpha_mode = alpha_mode_of(source.alphaMode, place, document_);
  material.alpha_cutoff = static_cast<float>(source.alphaCutoff);
  material.double_sided = source.doubleSided;
  material.unlit = source.extensions.count("KHR_materials_unlit") != 0;

  material.transmission =
      static_cast<float>(extension_number_or(source, "KHR_materials_transmission", "transmissionFactor", 0));
  if (material.transmission > 0) {
    document_.warn(
        "materials with KHR_materials_transmission are opaque in drawn images; lasers and paths of light see through "
        "them");
  }
  material.refractive_index = refractive_index_of(source, place, document_);

  const double factor = extension_number_or(source, "KHR_materials_emissive_strength", "emissiveStrength", 1);
  for (int i = 0; i < 3 && !material.unlit; ++i) {
    material.emissive[i] = product(source.emissiveFactor[static_cast<std::size_t>(i)], factor, place, document_);
  }

  const PictureUse use = material.alpha_mode == AlphaMode::opaque ? PictureUse::color : PictureUse::alpha;
  SurfaceMap base = map_of(source.pbrMetallicRoughness.baseColorTexture, use);
  material.base_color_texture = std::move(base.texture);
  material.uv_set = base.uv_set;
  material.uv_transform = base.uv_transform;
  if (!material.unlit) set_surface(source, material);
  return material;
}

// Properties that the file leaves out have glTF's defaults, with one exception: a material without any metallic or
// roughness property is matte. By glTF's defaults it would be a metal.
void GltfMaterials::set_surface(const tinygltf::Material& source, Material& material) {
  const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
  const auto& named = source.values;
  if (named.count("metallicFactor") + named.count("roughnessFactor") + named.count("metallicRoughnessTexture") > 0) {
    material.metallic = static_cast<float>(pbr.metallicFactor);
    material.roughness = static_cast<float>(pbr.roughnessFactor);
  }
  material.normal_scale = static_cast<float>(source.normalTexture.scale);
  material.occlusion_strength = static_cast<float>(source.occlusionTexture.strength);
  material.map(MapKind::normal) = map_of(source.normalTexture);
  material.map(MapKind::metallic_roughness) = map_of(pbr.metallicRoughnessTexture);
  material.map(MapKind::occlusion) = map_of(source.occlusionTexture);
  material.map(MapKind::emissive) = map_of(source.emissiveTexture);
}

template <typename TextureInfo>
SurfaceMap GltfMaterials::map_of(const TextureInfo& info, PictureUse use) {
  if (info.index < 0) return {};
  SurfaceMap map;
  map.uv_set = info.texCoord;
  const auto transform = info.extensions.find("KHR_texture_transform");
  if (transform != info.extensions.end()) {
    map.uv_set = static_cast<int>(number_or(transform->second, "texCoord", map.uv_set));
    map.uv_transform = uv_transform_of(transform->second);
  }
  if (map.uv_set > 1) {
    document_.warn("textures with texCoord above 1 are left out");
    return {};
  }
  map.texture = textures_.get(info.index, use);
  return map.texture ? map : SurfaceMap{};
}

}  // namespace simvis
