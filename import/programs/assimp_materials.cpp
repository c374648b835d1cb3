#include "import/programs/assimp_materials.h"

#include <assimp/material.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string_view>

#include <simvis/location.h>
#include "engine/base/srgb.h"
#include "import/programs/collada/collada_archive.h"

namespace simvis {
namespace {

Wrap wrap_of(aiTextureMapMode mode) {
  if (mode == aiTextureMapMode_Mirror) return Wrap::mirrored_repeat;
  return mode == aiTextureMapMode_Wrap ? Wrap::repeat : Wrap::clamp_to_edge;
}

std::string picture_name(const aiMaterial& source, aiTextureType type) {
  aiString path;
  return source.GetTexture(type, 0, &path) == aiReturn_SUCCESS ? path.C_Str() : "";
}

bool has_uv_transform(const aiMaterial& source) {
  aiUVTransform transform;
  if (source.Get(AI_MATKEY_UVTRANSFORM_DIFFUSE(0), transform) != aiReturn_SUCCESS) return false;
  return transform.mTranslation != aiVector2D(0, 0) || transform.mScaling != aiVector2D(1, 1) ||
         transform.mRotation != 0;
}

glm::vec3 linear_color(const AssimpFile& file, const aiColor4D& color, const std::string& subject) {
  glm::vec3 linear{0};
  for (unsigned i = 0; i < 3; ++i) {
    if (!std::isfinite(color[i]) || color[i] < 0) file.fail(subject + " has a colour that is negative or not finite");
    linear[static_cast<int>(i)] = linear_from_srgb(color[i]);
  }
  return linear;
}

}  // namespace

std::uint32_t AssimpMaterials::get(unsigned index, bool shaded, bool one_sided) {
  const auto [known, is_new] =
      numbers_.try_emplace({index, shaded, one_sided}, static_cast<std::uint32_t>(scene_.materials.size()));
  if (!is_new) return known->second;
  const aiMaterial& source = *file_.scene->mMaterials[index];
  const bool is_default = std::strcmp(source.GetName().C_Str(), AI_DEFAULT_MATERIAL_NAME) == 0;
  const bool is_nameless = is_default || source.GetName().length == 0;
  ImportedMaterial imported;
  imported.is_fallback = is_nameless && source.GetTextureCount(aiTextureType_DIFFUSE) == 0;
  if (!imported.is_fallback) imported = convert(source);
  if (is_default && !imported.is_fallback) {
    imported.material.name.clear();
    imported.material.base_color = glm::vec4(1);
  }
  imported.material.unlit = !shaded;
  imported.material.double_sided = !one_sided;
  scene_.materials.push_back(std::move(imported));
  return known->second;
}

ImportedMaterial AssimpMaterials::convert(const aiMaterial& source) {
  ImportedMaterial imported;
  Material& material = imported.material;
  material.name = source.GetName().C_Str();
  const std::string subject = "material " + in_quotes(material.name);
  aiColor4D color(1, 1, 1, 1);
  source.Get(AI_MATKEY_COLOR_DIFFUSE, color);
  float opacity = 1;
  source.Get(AI_MATKEY_OPACITY, opacity);
  if (!(opacity >= 0 && opacity <= 1)) file_.fail(subject + " has an opacity outside 0 to 1");
  material.base_color = glm::vec4(linear_color(file_, color, subject), opacity);
  if (opacity < 1) material.alpha_mode = AlphaMode::blend;
  aiColor4D emissive(0, 0, 0, 1);
  source.Get(AI_MATKEY_COLOR_EMISSIVE, emissive);
  material.emissive = linear_color(file_, emissive, subject);
  if (source.GetTextureCount(aiTextureType_DIFFUSE) > 0) set_picture(source, imported);
  return imported;
}

void AssimpMaterials::set_picture(const aiMaterial& source, ImportedMaterial& imported) {
  Material& material = imported.material;
  const std::string subject = "material " + in_quotes(material.name);
  const std::string name = picture_name(source, aiTextureType_DIFFUSE);
  if (source.GetTextureCount(aiTextureType_DIFFUSE) > 1)
    file_.warn(subject + ": pictures beyond the first are left out");
  if (has_uv_transform(source)) file_.warn(subject + ": the transformation of its picture is left out");
  int uv_set = 0;
  source.Get(AI_MATKEY_UVWSRC_DIFFUSE(0), uv_set);
  if (uv_set < 0 || uv_set > 1) {
    file_.warn(subject + ": pictures on a third set of texture coordinates are left out");
    return;
  }
  int wrap_u = aiTextureMapMode_Wrap, wrap_v = aiTextureMapMode_Wrap;
  source.Get(AI_MATKEY_MAPPINGMODE_U_DIFFUSE(0), wrap_u);
  source.Get(AI_MATKEY_MAPPINGMODE_V_DIFFUSE(0), wrap_v);
  const Sampler sampler{.wrap_u = wrap_of(static_cast<aiTextureMapMode>(wrap_u)),
                        .wrap_v = wrap_of(static_cast<aiTextureMapMode>(wrap_v))};
  material.uv_set = uv_set;
  imported.texture = picture(name, sampler);
  if (material.emissive != glm::vec3(0)) {
    imported.textured_emission = true;
    file_.warn(subject + ": its emission is multiplied by its picture");
  }
  // COLLADA has either a colour or a picture. With a picture Assimp returns a grey that is not in the file.
  material.base_color = glm::vec4(1, 1, 1, material.base_color.a);
  const std::string cut_out = picture_name(source, aiTextureType_OPACITY);
  if (cut_out == name) {
    material.alpha_mode = AlphaMode::mask;
  } else if (!cut_out.empty()) {
    file_.warn(subject + ": pictures of opacity are taken only where they are the colour's own");
  }
}

std::uint32_t AssimpMaterials::picture(const std::string& name, const Sampler& sampler) {
  if (name.starts_with('*')) file_.fail("has a picture within the file, expected pictures in files of their own");
  // Assimp keeps the white space at the end of a line.
  std::string path = name.substr(0, name.find_last_not_of(" \t\r") + 1);
  std::ranges::replace(path, '\\', '/');
  if (path.empty()) file_.fail("has a picture without a name");
  const auto [known, is_new] =
      pictures_.try_emplace({path, sampler.wrap_u, sampler.wrap_v}, static_cast<std::uint32_t>(scene_.textures.size()));
  if (!is_new) return known->second;
  ImportedTexture texture;
  if (file_.archive) {
    try {
      texture.texture = file_.archive->picture(path);
    } catch (const InputError& error) {
      std::string why = error.what();
      why.erase(why.find(" error:"), std::string_view(" error:").size());
      file_.warnings.push_back(why + "; materials with it are white");
      return known->second = kNoTexture;
    }
  }
  texture.texture.name = path;
  if (!file_.archive) texture.file = path;
  texture.texture.sampler = sampler;
  scene_.textures.push_back(std::move(texture));
  return known->second;
}

}  // namespace simvis
