#include "program/live/glb_materials.h"

#include <algorithm>
#include <cmath>

#include "scenegraph/pictures/png_bytes.h"

namespace simvis::live {
namespace {

using Json = GlbBuffer::Json;

// Numbers of OpenGL, which glTF uses.
int wrap_code(Wrap wrap) {
  constexpr int kCodes[] = {10497, 33648, 33071};  // in the order of Wrap
  return kCodes[static_cast<std::size_t>(wrap)];
}

int minify_code(const Sampler& sampler) {
  const int linear = sampler.minify == Filter::linear ? 1 : 0;
  if (!sampler.mipmapped) return 9728 + linear;
  return 9984 + linear + (sampler.between_mips == Filter::linear ? 2 : 0);
}

Json sampler_json(const Sampler& sampler) {
  return {{"magFilter", sampler.magnify == Filter::linear ? 9729 : 9728},
          {"minFilter", minify_code(sampler)},
          {"wrapS", wrap_code(sampler.wrap_u)},
          {"wrapT", wrap_code(sampler.wrap_v)}};
}

float share(float value) { return std::clamp(value, 0.0f, 1.0f); }

/// The emission, split into a factor from 0 to 1 and a strength.
void add_emission(Json& json, const glm::vec3& emissive, std::set<std::string>& extensions) {
  const float largest = std::max({emissive.r, emissive.g, emissive.b});
  if (!(largest > 0)) return;
  const float strength = std::max(largest, 1.0f);
  json["emissiveFactor"] = {emissive.r / strength, emissive.g / strength, emissive.b / strength};
  if (strength == 1) return;
  json["extensions"]["KHR_materials_emissive_strength"] = {{"emissiveStrength", strength}};
  extensions.insert("KHR_materials_emissive_strength");
}

}  // namespace

float shown_alpha(const Material& material) {
  return (material.alpha_mode == AlphaMode::opaque ? 1.0f : material.base_color.a) * material.opacity;
}

bool reads_uv(const Material& material, int uv_set) {
  if (material.base_color_texture != nullptr && material.uv_set == uv_set) return true;
  return std::ranges::any_of(material.maps,
                             [&](const SurfaceMap& map) { return map.texture != nullptr && map.uv_set == uv_set; });
}

std::size_t GlbMaterials::texture(const std::shared_ptr<const Texture>& texture) {
  const auto [found, is_new] = numbers_.try_emplace(texture.get(), textures_.size());
  if (!is_new) return found->second;
  const std::string png = png_bytes(
      {.width = texture->width, .height = texture->height, .bits = 8, .channels = 4, .filter = PngFilter::paeth},
      texture->rgba);
  images_.push_back({{"name", texture->name},
                     {"bufferView", buffer_.add_view(png, GlbBuffer::Use::image)},
                     {"mimeType", "image/png"}});
  Json sampler = sampler_json(texture->sampler);
  auto place = std::ranges::find(samplers_, sampler);
  const auto number = static_cast<std::size_t>(place - samplers_.begin());
  if (number == samplers_.size()) samplers_.push_back(std::move(sampler));
  textures_.push_back({{"source", images_.size() - 1}, {"sampler", number}});
  return found->second;
}

Json GlbMaterials::texture_info(const std::shared_ptr<const Texture>& map, int uv_set, const glm::mat3x2& m) {
  Json info = {{"index", texture(map)}};
  if (uv_set != 0) info["texCoord"] = uv_set;
  if (m == glm::mat3x2(1, 0, 0, 1, 0, 0)) return info;
  // A shear, which glTF cannot say, is left out.
  const double turn = std::atan2(-m[0].y, m[0].x), s = std::sin(turn), c = std::cos(turn);
  info["extensions"]["KHR_texture_transform"] = {{"offset", {m[2].x, m[2].y}},
                                                 {"rotation", turn},
                                                 {"scale", {std::hypot(m[0].x, m[0].y), s * m[1].x + c * m[1].y}}};
  extensions_.insert("KHR_texture_transform");
  return info;
}

void GlbMaterials::add_surface(Json& json, const Material& m) {
  const auto add = [&](Json& where, const char* name, MapKind kind) -> Json* {
    const SurfaceMap& map = m.map(kind);
    if (map.texture == nullptr) return nullptr;
    where[name] = texture_info(map.texture, map.uv_set, map.uv_transform);
    return &where[name];
  };
  add(json["pbrMetallicRoughness"], "metallicRoughnessTexture", MapKind::metallic_roughness);
  if (Json* const normal = add(json, "normalTexture", MapKind::normal)) (*normal)["scale"] = m.normal_scale;
  if (Json* const occlusion = add(json, "occlusionTexture", MapKind::occlusion)) {
    (*occlusion)["strength"] = share(m.occlusion_strength);
  }
  add(json, "emissiveTexture", MapKind::emissive);
  add_emission(json, m.emissive, extensions_);
}

std::size_t GlbMaterials::add(const Material& m, std::size_t index_in_list) {
  const bool fades = m.opacity < 1;
  const AlphaMode mode = fades ? AlphaMode::blend : m.alpha_mode;
  const glm::vec4& c = m.base_color;
  Json json = {{"name", m.name},
               {"pbrMetallicRoughness",
                {{"baseColorFactor",
                  {share(c.r), share(c.g), share(c.b), mode == AlphaMode::opaque ? share(c.a) : share(shown_alpha(m))}},
                 {"metallicFactor", share(m.metallic)},
                 {"roughnessFactor", share(m.roughness)}}},
               {"doubleSided", m.double_sided},
               {"extras", {{"material", index_in_list}}}};
  if (mode == AlphaMode::blend) json["alphaMode"] = "BLEND";
  if (mode == AlphaMode::mask) {
    json["alphaMode"] = "MASK";
    json["alphaCutoff"] = m.alpha_cutoff;
  }
  if (m.base_color_texture != nullptr) {
    json["pbrMetallicRoughness"]["baseColorTexture"] = texture_info(m.base_color_texture, m.uv_set, m.uv_transform);
  }
  if (m.unlit) {
    json["extensions"]["KHR_materials_unlit"] = Json::object();
    extensions_.insert("KHR_materials_unlit");
  } else {
    add_surface(json, m);
    if (m.transmission > 0) {
      json["extensions"]["KHR_materials_transmission"] = {{"transmissionFactor", share(m.transmission)}};
      extensions_.insert("KHR_materials_transmission");
    }
    if (m.refractive_index != Material{}.refractive_index && m.refractive_index >= 1) {
      json["extensions"]["KHR_materials_ior"] = {{"ior", m.refractive_index}};
      extensions_.insert("KHR_materials_ior");
    }
  }
  materials_.push_back(std::move(json));
  return materials_.size() - 1;
}

void GlbMaterials::take(Json& gltf, std::set<std::string>& extensions) {
  const auto move = [&](const char* name, Json& array) {
    if (!array.empty()) gltf[name] = std::move(array);
  };
  move("materials", materials_);
  move("textures", textures_);
  move("images", images_);
  move("samplers", samplers_);
  extensions.insert(extensions_.begin(), extensions_.end());
}

}  // namespace simvis::live
