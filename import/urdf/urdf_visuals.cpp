#include "import/urdf/urdf_visuals.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/part_importer.h>
#include <simvis/pose.h>
#include "engine/base/read_fence.h"
#include "engine/base/srgb.h"
#include "import/mesh/picture_file.h"
#include "scenegraph/language/other_kinds.h"

namespace simvis {
namespace {

const char* solid_name(ModelShape::Kind kind) {
  if (kind == ModelShape::Kind::box) return "box";
  if (kind == ModelShape::Kind::capsule) return "capsule";
  return kind == ModelShape::Kind::cylinder ? "cylinder" : "sphere";
}

}  // namespace

NodePtr UrdfVisuals::make(const UrdfLink& link, const UrdfVisual& visual) {
  const auto separator = std::make_shared<Separator>();
  separator->name = visual.name.empty() ? link.name : visual.name;
  const ModelShape& shape = visual.shape;
  if (shape.link_from_shape != glm::dmat4(1)) separator->add(std::make_shared<Transform>(shape.link_from_shape));
  const std::shared_ptr<const Material> material = material_of(link, visual);
  if (shape.kind == ModelShape::Kind::mesh) {
    if (!add_mesh(link, visual, material, *separator)) return nullptr;
  } else {
    if (!(std::max({shape.size.x, shape.size.y, shape.size.z}) <= kMaxCoordinate_m)) {
      link.element.fail("has a " + std::string(solid_name(shape.kind)) +
                        " of a size that is not allowed, expected at most " + format_number(kMaxCoordinate_m) + " m");
    }
    separator->add(std::make_shared<MaterialNode>(material));
    add_shape_nodes(shape, shape_meshes_, *separator);
  }
  shown_.show();
  return separator;
}

std::shared_ptr<const Material> UrdfVisuals::material_of(const UrdfLink& link, const UrdfVisual& visual) {
  Material material;
  material.double_sided = true;
  if (visual.material) {
    const glm::dvec4& color = visual.material->color;
    const auto alpha = static_cast<float>(color.a);
    material.name = visual.material->name;
    material.base_color = {linear_from_srgb(color.r), linear_from_srgb(color.g), linear_from_srgb(color.b), alpha};
    if (alpha < 1) material.alpha_mode = AlphaMode::blend;
    if (!visual.material->texture.empty()) {
      const PictureUse use = alpha < 1 ? PictureUse::alpha : PictureUse::color;
      material.base_color_texture = read_texture(link, visual.material->texture, use, material.base_color);
      // The colour is meant for programs without textures.
      if (material.base_color_texture != nullptr) material.base_color = glm::vec4(1, 1, 1, alpha);
    }
  }
  return pool_.intern(std::move(material));
}

bool UrdfVisuals::add_mesh(const UrdfLink& link, const UrdfVisual& visual,
                           const std::shared_ptr<const Material>& material, Group& group) {
  const glm::dvec3& scale = visual.shape.size;
  const glm::dvec3 factors = glm::abs(scale);
  if (!(std::max({factors.x, factors.y, factors.z}) <= kMaxCoordinate_m)) {
    link.element.fail("has a mesh with a scale that is not allowed, expected factors other than 0, at most " +
                      format_number(kMaxCoordinate_m) + " either way");
  }
  const NodePtr content = read_mesh(link, visual.mesh, material);
  if (content == nullptr) return false;
  if (scale != glm::dvec3(1)) {
    glm::dmat4 matrix{1.0};
    for (int i = 0; i < 3; ++i) matrix[i][i] = scale[i];
    group.add(std::make_shared<Transform>(matrix));
  }
  group.add(content);
  return true;
}

void UrdfVisuals::look(const UrdfLink& link, const UrdfVisual& visual) {
  if (visual.shape.kind != ModelShape::Kind::mesh || find_mesh(link, visual.mesh)) shown_.show();
}

std::optional<std::filesystem::path> UrdfVisuals::find_mesh(const UrdfLink& link, const std::string& name) {
  std::optional<std::filesystem::path> path = find(link, name);
  if (!path) {
    leave_out(link, "mesh file " + in_quotes(name) + " is not there; " + packages_.tried());
  } else if (!ModelMeshes::is_known(*path)) {
    leave_out(link, "mesh file " + in_quotes(name) + " is of an unknown kind, expected " + kModelMeshEndings +
                        converter_of(*path));
    path.reset();
  } else if (!is_readable(*path)) {
    shown_.leave_out_outside(*path);
    path.reset();
  }
  return path;
}

NodePtr UrdfVisuals::read_mesh(const UrdfLink& link, const std::string& name,
                               const std::shared_ptr<const Material>& material) {
  const std::optional<std::filesystem::path> path = find_mesh(link, name);
  if (!path) return nullptr;
  try {
    NodePtr content = meshes_.read(*path, axes_, material, pool_);
    if (const std::optional<std::filesystem::path> place = readable_place(*path)) mesh_files_.emplace(name, *place);
    return content;
  } catch (const InputError& error) {
    leave_out(link, without_word_error(error.what()));
    return nullptr;
  }
}

void UrdfVisuals::leave_out(const UrdfLink& link, const std::string& why) {
  shown_.leave_out(why);
  warnings_.push_back(to_string(link.element.where()) + ": link " + in_quotes(link.name) + ": a visual is left out, " +
                      why);
}

std::shared_ptr<const Texture> UrdfVisuals::read_texture(const UrdfLink& link, const std::string& name, PictureUse use,
                                                         const glm::vec4& color) {
  const auto [known, is_new] = textures_.try_emplace({name, use, {color.r, color.g, color.b}});
  if (!is_new) return known->second;
  const std::string start = to_string(link.element.where()) + ": link " + in_quotes(link.name) +
                            ": the material's colour replaces its texture, ";
  const std::optional<std::filesystem::path> path = find(link, name);
  if (!path) {
    warnings_.push_back(start + "picture " + in_quotes(name) + " is not there; " + packages_.tried());
    return nullptr;
  }
  const auto read = [path = *path, name, start](std::vector<std::string>& warnings) -> std::optional<Texture> {
    try {
      Texture texture = read_picture_file(path);
      texture.name = name;
      return texture;
    } catch (const InputError& error) {
      warnings.push_back(start + without_word_error(error.what()));
      return std::nullopt;
    }
  };
  known->second = pool_.picture(
      {.read = read, .use = use, .without = [color](Material& material) { material.base_color = color; }}, warnings_);
  return known->second;
}

std::optional<std::filesystem::path> UrdfVisuals::find(const UrdfLink& link, const std::string& name) {
  return packages_.find(name, link.element.where());
}

std::vector<std::string> UrdfVisuals::release_warnings() {
  if (std::optional<std::string> outside = shown_.outside_warning()) warnings_.push_back(std::move(*outside));
  std::ranges::move(meshes_.release_warnings(), std::back_inserter(warnings_));
  std::ranges::move(packages_.release_warnings(), std::back_inserter(warnings_));
  return std::move(warnings_);
}

}  // namespace simvis
