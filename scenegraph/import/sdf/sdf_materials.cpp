#include "scenegraph/import/sdf/sdf_materials.h"

#include <algorithm>
#include <system_error>
#include <utility>
#include <vector>

#include "engine/base/srgb.h"
#include "scenegraph/import/mesh/picture_file.h"
#include "scenegraph/import/urdf/urdf_file.h"

namespace simvis {
namespace {

// Defaults of the format for <metalness> and <roughness>.
constexpr double kSdfMetalness = 0.5, kSdfRoughness = 0.5;
// Half a step of 8 bits: what is below is wholly transparent.
constexpr double kMinVisibleAlpha = 0.5 / 255;

glm::vec3 linear_rgb(const glm::dvec3& color) {
  return {linear_from_srgb(color.x), linear_from_srgb(color.y), linear_from_srgb(color.z)};
}

std::vector<std::filesystem::path> scripts_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> scripts;
  std::error_code error;
  for (std::filesystem::directory_iterator each(folder, error), end; !error && each != end; each.increment(error)) {
    if (each->path().extension() == ".material") scripts.push_back(each->path());
  }
  std::ranges::sort(scripts);
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
  glm::dvec4 color = diffuse.color(glm::dvec4(1));
  material.emissive = linear_rgb(glm::dvec3(element.child("emissive").color({0, 0, 0, 1})));
  bool says_something = diffuse || workflow;
  if (!says_something && script && read_script(script, material)) return pool_.intern(std::move(material));
  if (!says_something && ambient) {
    color = ambient.color(color);
    says_something = true;
  }
  if (!says_something) return nullptr;
  if (color.a < kMinVisibleAlpha) {
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

void SdfMaterials::read_maps(const SdfElement& workflow, Material& material) {
  for (const SdfElement& each : workflow.children()) {
    const std::string_view tag = each.tag();
    if (each.text().empty()) continue;
    if (tag == "albedo_map") {
      material.base_color_texture = map(each);
    } else if (tag == "normal_map") {
      material.map(MapKind::normal).texture = map(each);
    } else if (tag == "ambient_occlusion_map") {
      material.map(MapKind::occlusion).texture = map(each);
    } else if (tag == "emissive_map") {
      material.map(MapKind::emissive).texture = map(each);
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
    report_.warn(script.at(),
                 "material " + in_quotes(name) + " of a script is not known; the shape keeps its own look");
    return false;
  }
  material.name = name;
  const glm::dvec4 color = found->diffuse.value_or(found->ambient.value_or(glm::dvec4(1)));
  material.base_color = glm::vec4(linear_rgb(glm::dvec3(color)), color.a);
  if (color.a < 1) material.alpha_mode = AlphaMode::blend;
  material.emissive = linear_rgb(found->emissive);
  if (found->texture.empty()) return true;
  std::error_code error;
  const std::vector<std::filesystem::path> places = {folder / found->texture, folder / "../textures" / found->texture,
                                                     folder / "../materials/textures" / found->texture};
  for (const std::filesystem::path& file : places) {
    if (!std::filesystem::is_regular_file(file, error)) continue;
    material.base_color_texture = picture(file.lexically_normal(), script);
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

std::shared_ptr<const Texture> SdfMaterials::map(const SdfElement& element) {
  std::string why;
  if (const auto file = files_.find(element.text(), element, why)) return picture(*file, element);
  report_.warn(element.at(), "picture " + why + "; the material does without it");
  return nullptr;
}

std::shared_ptr<const Texture> SdfMaterials::picture(const std::filesystem::path& file, const SdfElement& where) {
  const auto [known, is_new] = pictures_.try_emplace(file);
  if (!is_new) return known->second;
  try {
    Texture texture = read_picture_file(file);
    texture.name = file.filename().string();
    known->second = pool_.intern(std::move(texture));
  } catch (const InputError& error) {
    report_.warn(to_string(where.at()) + ": " + without_word_error(error.what()) + "; the material does without it");
  }
  return known->second;
}

}  // namespace simvis
