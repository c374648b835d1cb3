#include "scenegraph/import/urdf/urdf_visuals.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <system_error>

#include <simvis/attributes.h>
#include <simvis/pose.h>
#include "engine/base/srgb.h"
#include "scenegraph/import/mesh/mesh_file.h"
#include "scenegraph/import/mesh/picture_file.h"
#include "scenegraph/import/urdf/urdf_pose.h"
#include "scenegraph/primitive_meshes.h"

namespace simvis {
namespace {

constexpr std::string_view kPackage = "package://", kModel = "model://", kFile = "file://";

// Returns the possible paths of a file that a URDF names. The folder of a package is an ancestor of the URDF's folder,
// or a direct child of an ancestor.
std::vector<std::filesystem::path> places_of(const std::filesystem::path& folder, std::string name) {
  if (name.starts_with(kFile)) return {name.substr(kFile.size())};
  const bool is_model = name.starts_with(kModel);
  if (!name.starts_with(kPackage) && !is_model) return {folder / name};
  name = name.substr(is_model ? kModel.size() : kPackage.size());
  const std::string package = name.substr(0, name.find('/'));
  const std::string rest = package.size() < name.size() ? name.substr(package.size() + 1) : "";
  std::vector<std::filesystem::path> places;
  for (std::filesystem::path above = folder;; above = above.parent_path()) {
    if (above.filename() == package) places.push_back(above / rest);
    places.push_back(above / package / rest);
    if (above == above.parent_path()) return places;
  }
}

std::shared_ptr<Shape> shape_of(ContentPool& pool, Mesh mesh) {
  const auto shape = std::make_shared<Shape>(pool.intern(std::move(mesh)));
  shape->name = shape->mesh()->name;
  return shape;
}

}  // namespace

NodePtr UrdfVisuals::make(const urdf::Link& link, const urdf::Visual& visual) {
  const auto separator = std::make_shared<Separator>();
  separator->name = visual.name.empty() ? link.name : visual.name;
  const glm::dmat4 origin = matrix_of(visual.origin);
  if (origin != glm::dmat4(1)) separator->add(std::make_shared<Transform>(origin));
  const auto check = [&](const char* what, std::initializer_list<double> sizes_m) {
    for (const double size : sizes_m) {
      if (!(size > 0 && size <= kMaxCoordinate_m)) {
        file_.fail("link", link.name,
                   "has a " + std::string(what) +
                       " of a size that is not allowed, expected sizes above 0 and at most " +
                       format_number(kMaxCoordinate_m) + " m");
      }
    }
  };
  const std::shared_ptr<const Material> material = material_of(link, visual);
  const auto add_solid = [&](Mesh mesh) {
    separator->add(std::make_shared<MaterialNode>(material));
    separator->add(shape_of(pool_, std::move(mesh)));
  };
  switch (visual.geometry->type) {
    case urdf::Geometry::BOX: {
      const urdf::Vector3& size = static_cast<const urdf::Box&>(*visual.geometry).dim;
      check("box", {size.x, size.y, size.z});
      add_solid(box_mesh({size.x, size.y, size.z}));
      break;
    }
    case urdf::Geometry::CYLINDER: {
      const auto& cylinder = static_cast<const urdf::Cylinder&>(*visual.geometry);
      check("cylinder", {cylinder.radius, cylinder.length});
      add_solid(cylinder_mesh(cylinder.radius, cylinder.length));
      break;
    }
    case urdf::Geometry::SPHERE: {
      const double radius = static_cast<const urdf::Sphere&>(*visual.geometry).radius;
      check("sphere", {radius});
      add_solid(sphere_mesh(radius));
      break;
    }
    case urdf::Geometry::MESH:
      add_mesh(link, static_cast<const urdf::Mesh&>(*visual.geometry), material, *separator);
  }
  return separator;
}

std::shared_ptr<const Material> UrdfVisuals::material_of(const urdf::Link& link, const urdf::Visual& visual) {
  Material material;
  material.double_sided = true;
  if (!visual.material && !visual.material_name.empty()) {
    file_.fail("link", link.name, "has the material " + in_quotes(visual.material_name) + ", which is not defined");
  }
  if (visual.material) {
    material.name = visual.material->name;
    const urdf::Color& color = visual.material->color;
    material.base_color = {linear_from_srgb(color.r), linear_from_srgb(color.g), linear_from_srgb(color.b), color.a};
    if (color.a < 1) material.alpha_mode = AlphaMode::blend;
    if (!visual.material->texture_filename.empty()) {
      Texture texture = read_picture_file(find(link, visual.material->texture_filename, "picture"));
      texture.name = visual.material->texture_filename;
      material.base_color_texture = pool_.intern(std::move(texture));
      material.base_color = glm::vec4(1, 1, 1, color.a);  // the colour is meant for programs without textures
    }
  }
  return pool_.intern(std::move(material));
}

void UrdfVisuals::add_mesh(const urdf::Link& link, const urdf::Mesh& mesh,
                           const std::shared_ptr<const Material>& material, Group& group) {
  const glm::dvec3 scale(mesh.scale.x, mesh.scale.y, mesh.scale.z);
  for (int i = 0; i < 3; ++i) {
    if (scale[i] == 0 || std::abs(scale[i]) > kMaxCoordinate_m) {
      file_.fail("link", link.name,
                 "has a mesh with a scale that is not allowed, expected factors other than 0, at most " +
                     format_number(kMaxCoordinate_m) + " either way");
    }
  }
  const std::filesystem::path path = find(link, mesh.filename, "mesh file");
  if (!is_mesh_file(path)) {
    file_.fail("link", link.name,
               "has the mesh file " + in_quotes(mesh.filename) + ", expected .dae, .obj, .ply or .stl");
  }
  const auto [known, is_new] = meshes_.try_emplace({path, material.get()});
  if (is_new) {
    PartContent content = read_mesh_file(path, MeshFileAxes::as_written, material, pool_);
    known->second = content.root;
    std::ranges::move(content.warnings, std::back_inserter(warnings_));
  }
  if (scale != glm::dvec3(1)) {
    glm::dmat4 matrix{1.0};
    for (int i = 0; i < 3; ++i) matrix[i][i] = scale[i];
    group.add(std::make_shared<Transform>(matrix));
  }
  group.add(known->second);
}

std::filesystem::path UrdfVisuals::find(const urdf::Link& link, const std::string& name, const char* kind) const {
  std::error_code error;
  std::filesystem::path folder = std::filesystem::absolute(file_.text.source().file(), error).parent_path();
  std::string tried;
  for (const std::filesystem::path& place : places_of(folder.lexically_normal(), name)) {
    if (std::filesystem::is_regular_file(place, error)) return place;
    tried += (tried.empty() ? "" : ", ") + place.string();
  }
  file_.fail("link", link.name,
             "has the " + std::string(kind) + " " + in_quotes(name) + ", which does not exist; tried " + tried);
}

}  // namespace simvis
