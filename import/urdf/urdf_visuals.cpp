#include "import/urdf/urdf_visuals.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/part_importer.h>
#include <simvis/pose.h>
#include "engine/base/read_fence.h"
#include "engine/base/srgb.h"
#include "import/mesh/picture_file.h"
#include "import/urdf/urdf_pose.h"
#include "scenegraph/language/other_kinds.h"

namespace simvis {
namespace {

// Of a box, a cylinder, which may stand for a capsule, or a sphere.
ModelShape solid_of(const urdf::Geometry& geometry, bool is_capsule) {
  ModelShape shape;
  if (geometry.type == urdf::Geometry::BOX) {
    const urdf::Vector3& size = static_cast<const urdf::Box&>(geometry).dim;
    shape.size = {size.x, size.y, size.z};
  } else if (geometry.type == urdf::Geometry::CYLINDER) {
    const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
    shape.kind = is_capsule ? ModelShape::Kind::capsule : ModelShape::Kind::cylinder;
    shape.size = {cylinder.radius, cylinder.radius, cylinder.length};
  } else {
    shape.kind = ModelShape::Kind::sphere;
    shape.size = glm::dvec3(static_cast<const urdf::Sphere&>(geometry).radius);
  }
  return shape;
}

const char* solid_name(ModelShape::Kind kind) {
  if (kind == ModelShape::Kind::box) return "box";
  if (kind == ModelShape::Kind::capsule) return "capsule";
  return kind == ModelShape::Kind::cylinder ? "cylinder" : "sphere";
}

std::size_t number_of(const urdf::Visual& visual, const urdf::Link& link) {
  const auto is_same = [&](const auto& each) { return each.get() == &visual; };
  return static_cast<std::size_t>(std::ranges::find_if(link.visual_array, is_same) - link.visual_array.begin());
}

}  // namespace

NodePtr UrdfVisuals::make(const urdf::Link& link, const urdf::Visual& visual) {
  const auto separator = std::make_shared<Separator>();
  separator->name = visual.name.empty() ? link.name : visual.name;
  const glm::dmat4 origin = matrix_of(visual.origin);
  if (origin != glm::dmat4(1)) separator->add(std::make_shared<Transform>(origin));
  const std::shared_ptr<const Material> material = material_of(link, visual);
  if (visual.geometry->type == urdf::Geometry::MESH) {
    if (!add_mesh(link, static_cast<const urdf::Mesh&>(*visual.geometry), material, *separator)) return nullptr;
  } else {
    const ModelShape solid =
        solid_of(*visual.geometry, file_.mending.capsules.contains({link.name, number_of(visual, link)}));
    for (int i = 0; i < 3; ++i) {
      if (solid.size[i] > 0 && solid.size[i] <= kMaxCoordinate_m) continue;
      file_.fail("link", link.name,
                 "has a " + std::string(solid_name(solid.kind)) +
                     " of a size that is not allowed, expected sizes above 0 and at most " +
                     format_number(kMaxCoordinate_m) + " m");
    }
    separator->add(std::make_shared<MaterialNode>(material));
    add_shape_nodes(solid, shape_meshes_, *separator);
  }
  shown_.show();
  return separator;
}

std::shared_ptr<const Material> UrdfVisuals::material_of(const urdf::Link& link, const urdf::Visual& visual) {
  Material material;
  material.double_sided = true;
  if (visual.material) {
    material.name = visual.material->name;
    const urdf::Color& color = visual.material->color;
    material.base_color = {linear_from_srgb(color.r), linear_from_srgb(color.g), linear_from_srgb(color.b), color.a};
    if (color.a < 1) material.alpha_mode = AlphaMode::blend;
    if (!visual.material->texture_filename.empty()) {
      const PictureUse use = color.a < 1 ? PictureUse::alpha : PictureUse::color;
      material.base_color_texture = read_texture(link, visual.material->texture_filename, use, material.base_color);
      // The colour is meant for programs without textures.
      if (material.base_color_texture != nullptr) material.base_color = glm::vec4(1, 1, 1, color.a);
    }
  }
  return pool_.intern(std::move(material));
}

bool UrdfVisuals::add_mesh(const urdf::Link& link, const urdf::Mesh& mesh,
                           const std::shared_ptr<const Material>& material, Group& group) {
  const glm::dvec3 scale(mesh.scale.x, mesh.scale.y, mesh.scale.z);
  for (int i = 0; i < 3; ++i) {
    if (scale[i] == 0 || !(std::abs(scale[i]) <= kMaxCoordinate_m)) {
      file_.fail("link", link.name,
                 "has a mesh with a scale that is not allowed, expected factors other than 0, at most " +
                     format_number(kMaxCoordinate_m) + " either way");
    }
  }
  const NodePtr content = read_mesh(link, mesh.filename, material);
  if (content == nullptr) return false;
  if (scale != glm::dvec3(1)) {
    glm::dmat4 matrix{1.0};
    for (int i = 0; i < 3; ++i) matrix[i][i] = scale[i];
    group.add(std::make_shared<Transform>(matrix));
  }
  group.add(content);
  return true;
}

void UrdfVisuals::look(const urdf::Link& link, const urdf::Visual& visual) {
  const bool is_mesh = visual.geometry->type == urdf::Geometry::MESH;
  if (!is_mesh || find_mesh(link, static_cast<const urdf::Mesh&>(*visual.geometry).filename)) shown_.show();
}

std::optional<std::filesystem::path> UrdfVisuals::find_mesh(const urdf::Link& link, const std::string& name) {
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

NodePtr UrdfVisuals::read_mesh(const urdf::Link& link, const std::string& name,
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

void UrdfVisuals::leave_out(const urdf::Link& link, const std::string& why) {
  shown_.leave_out(why);
  warnings_.push_back(to_string(file_.at("link", link.name)) + ": link " + in_quotes(link.name) +
                      ": a visual is left out, " + why);
}

std::shared_ptr<const Texture> UrdfVisuals::read_texture(const urdf::Link& link, const std::string& name,
                                                         PictureUse use, const glm::vec4& color) {
  const auto [known, is_new] = textures_.try_emplace({name, use, {color.r, color.g, color.b}});
  if (!is_new) return known->second;
  const std::string start = to_string(file_.at("link", link.name)) + ": link " + in_quotes(link.name) +
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

std::optional<std::filesystem::path> UrdfVisuals::find(const urdf::Link& link, const std::string& name) {
  return packages_.find(name, file_.at("link", link.name));
}

std::vector<std::string> UrdfVisuals::release_warnings() {
  if (std::optional<std::string> outside = shown_.outside_warning()) warnings_.push_back(std::move(*outside));
  std::ranges::move(meshes_.release_warnings(), std::back_inserter(warnings_));
  std::ranges::move(packages_.release_warnings(), std::back_inserter(warnings_));
  return std::move(warnings_);
}

}  // namespace simvis
