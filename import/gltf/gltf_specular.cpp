#include "import/gltf/gltf_specular.h"

namespace simvis {
namespace {

using nlohmann::json;

json base_of(const json& extension) {
  json base = {{"metallicFactor", 0}};
  if (extension.contains("diffuseFactor")) base["baseColorFactor"] = extension["diffuseFactor"];
  if (extension.contains("diffuseTexture")) base["baseColorTexture"] = extension["diffuseTexture"];
  const auto glossiness = extension.find("glossinessFactor");
  const bool has_number = glossiness != extension.end() && glossiness->is_number();
  base["roughnessFactor"] = has_number ? 1 - glossiness->get<double>() : 0.0;
  return base;
}

}  // namespace

bool read_specular_glossiness(json& root) {
  const auto materials = root.is_object() ? root.find("materials") : root.end();
  if (!root.is_object() || materials == root.end() || !materials->is_array()) return false;
  bool found = false;
  for (json& material : *materials) {
    if (!material.is_object() || material.contains("pbrMetallicRoughness")) continue;
    const json::json_pointer place("/extensions/KHR_materials_pbrSpecularGlossiness");
    if (!material.contains(place) || !material[place].is_object()) continue;
    json base = base_of(material[place]);
    material["pbrMetallicRoughness"] = std::move(base);
    found = true;
  }
  return found;
}

}  // namespace simvis
