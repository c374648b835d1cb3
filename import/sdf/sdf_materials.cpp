#include "import/sdf/sdf_materials.h"

#include <algorithm>
#include <system_error>
#include <utility>
#include <vector>

#include "engine/base/folder_entries.h"
#include "engine/base/read_error.h"
#include "engine/base/srgb.h"
#include "import/mesh/picture_file.h"

namespace simvis {
namespace {

// Defaults of the format for <metalness> and <roughness>.
constexpr double kSdfMetalness = 0.5, kSdfRoughness = 0.5;

glm::vec3 linear_rgb(const glm::dvec3& color) {
  return {linear_from_srgb(color.x), linear_from_srgb(color.y), linear_from_srgb(color.z)};
}

std::vector<std::filesystem::path> scripts_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> scripts;
  for (const std::filesystem::path& each : folder_entries(folder)) {
    if (each.extension() == ".material") scripts.push_back(each);
  }
  return scripts;
}

}  // namespace

Material SdfMaterials::plain(double opacity) {
  Material material;
  material.double_sided = true;
  material.opacity = static_cast<float>(opacity);
  return material;
}

std::shared_ptr<const Material> SdfMaterials::read(const SdfElement& element, const std::string& name, double opacity) {
  if (!element) return nullptr;
  Material material = plain(opacity);
  material.name = name;
  const SdfElement pbr = element.child("pbr"), diffuse = element.child("diffuse"), ambient = element.child("ambient");
  const SdfElement script = element.child("script");
  const SdfElement metal = pbr.child("metal"), workflow = metal ? metal : pbr.child("specular");
  glm::dvec4 color = diffuse.color(glm::dvec4(1), report_);
  material.emissive = linear_rgb(glm::dvec3(element.child("emissive").color({0, 0, 0, 1}, report_)));
  bool says_something = diffuse || workflow;
  if (!says_something && script && read_script(script, material)) return pool_.intern(std::move(material));
  if (!says_something && ambient) {
    color = ambient.color(color, report_);
    says_something = true;
  }
  if (!says_something) return nullptr;
  if (color.a < kWhollyTransparent) {
    report_.warn(diffuse.at(), "the colour is wholly transparent; it is read as opaque");
    color.a = 1;
  }
  material.base_color = glm::vec4(linear_rgb(glm::dvec3(color)), color.a);
  if (color.a < 1) material.alpha_mode = AlphaMode::blend;
  if (metal) {
    material.metallic = static_cast<float>(std::clamp(metal.child("metalness").number(kSdfMetalness), 0.0, 1.0));
    material.roughness = static_cast<float>(std::clamp(metal.child("roughness").number(kSdfRoughness), 0.0, 1.0));
  }
  if (workflow) read_maps(workflow, material);
  if (!element.child("lighting").flag(true)) material.unlit = true;
  return pool_.intern(std::move(material));
}

std::shared_ptr<const Material> SdfMaterials::of_heightmap(const SdfElement& texture, const glm::dvec2& size_m,
                                                           double opacity) {
  Material material = plain(opacity);
  material.name = "heightmap";
  material.base_color_texture = map(texture.child("diffuse"), Look{});
  const double repeat_m = texture.child("size").number(10);
  constexpr double kMinRepeat_m = 1e-6;
  if (!(repeat_m >= kMinRepeat_m)) texture.fail("has a <size> that is not above 0");
  material.uv_transform = glm::mat3x2(size_m.x / repeat_m, 0, 0, size_m.y / repeat_m, 0, 0);
  return pool_.intern(std::move(material));
}

SdfMaterials::Look SdfMaterials::look_of(const Material& material) {
  return {.use = material.alpha_mode == AlphaMode::opaque ? PictureUse::color : PictureUse::alpha};
}

void SdfMaterials::read_maps(const SdfElement& workflow, Material& material) {
  for (const SdfElement& each : workflow.children()) {
    const std::string_view tag = each.tag();
    if (each.text().empty()) continue;
    if (tag == "albedo_map") {
      material.base_color_texture = map(each, look_of(material));
    } else if (tag == "normal_map") {
      material.map(MapKind::normal).texture = map(each, Look{});
    } else if (tag == "ambient_occlusion_map") {
      material.map(MapKind::occlusion).texture = map(each, Look{});
    } else if (tag == "emissive_map") {
      const auto without = [own = material.emissive](Material& changed) { changed.emissive = own; };
      material.map(MapKind::emissive).texture = map(each, {.without = without});
      if (material.map(MapKind::emissive).texture != nullptr) material.emissive = glm::vec3(1);
    } else if (tag.ends_with("_map")) {
      report_.leave_out("element <" + std::string(tag) + "> of a material", each.at());
    }
  }
}

bool SdfMaterials::read_script(const SdfElement& script, Material& material) {
  const std::string name = script.child("name") ? script.child("name").text() : script.text();
  if (name.empty()) return false;
  std::filesystem::path folder;
  const std::optional<OgreMaterial> found = find_script(script, name, folder);
  if (!found) {
    report_.warn_once(script.at(),
                      "material " + in_quotes(name) + " of a script is not known; the shape keeps its own look");
    return false;
  }
  material.name = name;
  const glm::dvec4 color = found->diffuse.value_or(found->ambient.value_or(glm::dvec4(1)));
  material.base_color = glm::vec4(linear_rgb(glm::dvec3(color)), color.a);
  if (color.a < 1) material.alpha_mode = AlphaMode::blend;
  material.emissive = linear_rgb(found->emissive);
  if (found->texture.empty()) return true;
  const std::vector<std::filesystem::path> places = {folder / found->texture, folder / "../textures" / found->texture,
                                                     folder / "../materials/textures" / found->texture};
  for (const std::filesystem::path& file : places) {
    if (!is_input_file(file)) continue;
    material.base_color_texture = picture(file.lexically_normal(), script, look_of(material));
    return true;
  }
  report_.warn(script.at(), "texture " + in_quotes(found->texture) + " of material " + in_quotes(name) +
                                " is not there; the material's colour replaces it");
  return true;
}

std::optional<OgreMaterial> SdfMaterials::find_script(const SdfElement& script, const std::string& name,
                                                      std::filesystem::path& folder) {
  if (auto known = find_gazebo_color(name)) return known;
  for (const SdfElement& uri : script.children()) {
    if (uri.tag() != "uri") continue;
    std::string why;
    for (const std::filesystem::path& file : files_.find_scripts(uri.text(), uri)) {
      const std::vector<std::filesystem::path> in_folder = scripts_in(file);
      for (const std::filesystem::path& each : in_folder.empty() ? std::vector{file} : in_folder) {
        if (auto found = find_ogre_material(each, name)) {
          folder = each.parent_path();
          return found;
        }
      }
    }
  }
  return std::nullopt;
}

std::shared_ptr<const Texture> SdfMaterials::map(const SdfElement& element, Look look) {
  std::string why;
  if (const auto file = files_.find(element.text(), element, why)) return picture(*file, element, std::move(look));
  report_.warn(element.at(), "picture " + why + "; the material does without it");
  return nullptr;
}

std::shared_ptr<const Texture> SdfMaterials::picture(const std::filesystem::path& file, const SdfElement& where,
                                                     Look look) {
  const auto [known, is_new] = pictures_.try_emplace({file, look.use});
  if (!is_new && !look.without) return known->second;
  const auto read = [file, place = to_string(where.at())](std::vector<std::string>& warnings) {
    std::optional<Texture> texture;
    try {
      texture = read_picture_file(file);
      texture->name = file.filename().string();
    } catch (const InputError& error) {
      warnings.push_back(place + ": " + without_word_error(error.what()) + "; the material does without it");
    }
    return texture;
  };
  std::vector<std::string> warnings;
  known->second = pool_.picture({.read = read, .use = look.use, .without = std::move(look.without)}, warnings);
  for (std::string& warning : warnings) report_.warn(std::move(warning));
  return known->second;
}

}  // namespace simvis
