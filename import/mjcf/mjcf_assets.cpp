#include "import/mjcf/mjcf_assets.h"

#include <strings.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <system_error>
#include <utility>
#include <vector>

#include <simvis/pose.h>
#include "engine/base/read_error.h"
#include "engine/base/read_fence.h"
#include "engine/base/srgb.h"
#include "import/mesh/mesh_file.h"
#include "import/mesh/picture_file.h"
#include "import/mesh/shape_node.h"
#include "import/mjcf/mjcf_cube.h"
#include "import/mjcf/mjcf_heights.h"
#include "import/mjcf/mjcf_mesh_data.h"
#include "import/mjcf/mjcf_pictures.h"
#include "import/mjcf/mjcf_solid.h"
#include "import/model/projected_picture.h"
#include "scenegraph/graph_walk.h"
#include "scenegraph/primitive_meshes.h"

namespace simvis {
namespace {

constexpr double kMinPicture_m = 1e-9;                              // of a shape that has no extent along an axis
constexpr std::array<double, 4> kDefaultRgba = {0.5, 0.5, 0.5, 1};  // of a geom

glm::vec4 linear_color(const std::vector<double>& rgba) {
  return {linear_from_srgb(std::clamp(rgba[0], 0.0, 1.0)), linear_from_srgb(std::clamp(rgba[1], 0.0, 1.0)),
          linear_from_srgb(std::clamp(rgba[2], 0.0, 1.0)), rgba.size() > 3 ? std::clamp(rgba[3], 0.0, 1.0) : 1};
}

// The name of an asset: its own, or that of its file without the ending.
std::string asset_name(const MjcfElement& asset) {
  if (const auto name = asset.written("name")) return *name;
  return std::filesystem::path(asset.text("file")).stem().string();
}

// The shapes of a graph with their places in it, and the box around them.
struct PlacedShapes {
  struct Each {
    glm::dmat4 place;
    const Shape* shape;
  };
  std::vector<Each> all{};
  glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};

  glm::dvec3 middle() const { return low.x <= high.x ? (low + high) / 2.0 : glm::dvec3(0); }
};

PlacedShapes shapes_of(const Group& root) {
  PlacedShapes shapes;
  walk_graph(root, {.visit =
                        [&](const Node& node, const WalkState& state) {
                          if (node.kind() != NodeKind::shape) return;
                          shapes.all.push_back({state.world_from_node, static_cast<const Shape*>(&node)});
                          for (const glm::vec3& position : shapes.all.back().shape->mesh()->positions) {
                            const glm::dvec3 at(state.world_from_node * glm::dvec4(position, 1));
                            shapes.low = glm::min(shapes.low, at);
                            shapes.high = glm::max(shapes.high, at);
                          }
                        },
                    .leave = {}});
  return shapes;
}

// Adds each shape under its transform, with the mesh that `mesh_of` gives it.
template <class MeshOf>
void add_shapes(const PlacedShapes& shapes, const MeshOf& mesh_of, Group& group) {
  for (const PlacedShapes::Each& each : shapes.all) {
    const auto separator = std::make_shared<Separator>();
    separator->add(std::make_shared<Transform>(each.place));
    const auto shape = std::make_shared<Shape>(mesh_of(each));
    shape->name = each.shape->name;
    separator->add(shape);
    group.add(separator);
  }
}

bool has_coordinates(const PlacedShapes& shapes) {
  return std::ranges::any_of(shapes.all, [](const PlacedShapes::Each& each) {
    return std::ranges::any_of(each.shape->mesh()->attributes,
                               [](const VertexAttributes& vertex) { return vertex.uv[0] != glm::vec2(0); });
  });
}

}  // namespace

MjcfAssets::Tables& MjcfAssets::tables_of(const MjcfModel& model) {
  const auto [known, is_new] = tables_.try_emplace(&model);
  Tables& tables = known->second;
  if (!is_new) return tables;
  for (const MjcfElement& section : model.sections("asset")) {
    for (const MjcfElement& asset : section.children()) {
      if (asset.tag() == "mesh") {
        tables.meshes.emplace(asset_name(asset), asset);
      } else if (asset.tag() == "material") {
        tables.materials.emplace(asset_name(asset), asset);
      } else if (asset.tag() == "texture") {
        tables.textures.emplace(asset_name(asset), asset);
      } else if (asset.tag() == "hfield") {
        tables.fields.emplace(asset_name(asset), asset);
      } else if (asset.tag() != "model") {  // which an <attach> reads
        report_.leave_out("asset <" + std::string(asset.tag()) + ">", asset.at());
      }
    }
  }
  return tables;
}

const MjcfMesh& MjcfAssets::mesh(const MjcfElement& geom, const MjcfLook& look) {
  const MjcfReadAssets::Key key(&geom.model(), geom.text("mesh"));
  const auto [known, is_new] = read_.meshes.try_emplace(key);
  if (is_new) {
    const Tables& tables = tables_of(geom.model());
    const auto asset = tables.meshes.find(key.second);
    try {
      if (asset != tables.meshes.end()) known->second = read_mesh(asset->second);
      if (asset == tables.meshes.end()) known->second.error = "there is no mesh " + in_quotes(key.second);
    } catch (const OutsideFolders&) {
      read_.meshes.erase(known);
      throw;
    } catch (const InputError& error) {
      known->second.error = without_word_error(error.what());
    }
  }
  if (known->second.shapes == nullptr) return known->second;
  if (look.is_projected) {
    const auto [projected, is_first] = read_.flat_pictured_meshes.try_emplace(key);
    if (is_first) projected->second = projected_mesh(known->second);
    return projected->second;
  }
  if (look.sides == CubeSides::none) return known->second;
  const auto [textured, is_first] = read_.cube_meshes.try_emplace({key, look.sides});
  if (is_first) textured->second = cube_mesh(known->second, look.sides);
  return textured->second;
}

// The cube is as large as it is wide; how large does not matter.
MjcfMesh MjcfAssets::cube_mesh(const MjcfMesh& plain, CubeSides sides) {
  const PlacedShapes shapes = shapes_of(static_cast<const Group&>(*plain.shapes));
  glm::dmat4 to_middle(1);
  to_middle[3] = glm::dvec4(-shapes.middle(), 1);
  const auto group = std::make_shared<Separator>();
  group->name = plain.shapes->name;
  add_shapes(
      shapes,
      [&](const PlacedShapes::Each& each) {
        return pool_.intern(cube_textured(*each.shape->mesh(), to_middle * each.place, sides));
      },
      *group);
  return {group, ""};
}

MjcfMesh MjcfAssets::projected_mesh(const MjcfMesh& plain) {
  const PlacedShapes shapes = shapes_of(static_cast<const Group&>(*plain.shapes));
  const glm::dvec3 middle = shapes.middle(), size = glm::max(shapes.high - shapes.low, glm::dvec3(kMinPicture_m));
  glm::dmat4 box_from_part(1);
  for (int i = 0; i < 3; ++i) {
    box_from_part[i][i] = 2 / size[i];
    box_from_part[3][i] = -2 * middle[i] / size[i];
  }
  const auto group = std::make_shared<Separator>();
  group->name = plain.shapes->name;
  add_shapes(
      shapes,
      [&](const PlacedShapes::Each& each) {
        return pool_.intern(with_projected_picture(*each.shape->mesh(), box_from_part * each.place));
      },
      *group);
  return {group, ""};
}

MjcfMesh MjcfAssets::read_mesh(const MjcfElement& asset) {
  const NodePtr content = read_mesh_content(asset);
  const auto group = std::make_shared<Separator>();
  group->name = asset_name(asset);
  const glm::dvec3 scale = asset.vector("scale", glm::dvec3(1)), origin = asset.vector("refpos", glm::dvec3(0));
  // MuJoCo moves the vertices by refpos, turns them back by refquat, and scales them at last.
  glm::dmat4 turn(1), stretch(1), move(1);
  if (const auto q = asset.numbers("refquat", 4, 4); !q.empty()) {
    const glm::dquat quaternion(q[0], q[1], q[2], q[3]);
    if (!(glm::length(quaternion) > 0)) asset.fail("has a quaternion without length");
    turn = glm::transpose(glm::mat4_cast(glm::normalize(quaternion)));
  }
  for (int i = 0; i < 3; ++i) {
    if (scale[i] == 0) asset.fail("has a scale of 0");
    stretch[i][i] = scale[i];
  }
  move[3] = glm::dvec4(-origin, 1);
  const glm::dmat4 matrix = stretch * turn * move;
  if (matrix != glm::dmat4(1)) group->add(std::make_shared<Transform>(matrix));
  add_shapes(
      shapes_of(static_cast<const Group&>(*content)), [](const PlacedShapes::Each& each) { return each.shape->mesh(); },
      *group);
  return {group, ""};
}

NodePtr MjcfAssets::read_mesh_content(const MjcfElement& asset) {
  const std::string name = asset.text("file");
  const auto from_mesh = [&](Mesh mesh) {
    const auto root = std::make_shared<Separator>();
    mesh.name = asset_name(asset);
    root->add(shape_node(std::move(mesh), pool_));
    return root;
  };
  if (name.empty() && asset.find("vertex")) return from_mesh(inline_mjcf_mesh(asset));
  if (name.empty()) asset.fail("has neither \"file\" nor \"vertex\": built-in meshes are not taken over");
  const std::filesystem::path file = asset.model().asset_file(asset, asset.model().mesh_folder, name);
  if (!is_input_file(file)) asset.fail("names a file that is not there: " + in_quotes(file.string()));
  if (::strcasecmp(file.extension().c_str(), ".msh") == 0) {
    Mesh mesh = read_msh_file(file);
    return from_mesh(mesh.indices.empty() ? mjcf_hull(asset, std::move(mesh.positions)) : std::move(mesh));
  }
  if (!is_mesh_file(file)) asset.fail("names " + in_quotes(file.string()) + ", expected .obj, .stl or .msh");
  PartContent content = read_mesh_file(file, MeshFileAxes::as_written, std::make_shared<const Material>(), pool_);
  for (std::string& warning : content.warnings) report_.warn(std::move(warning));
  const PlacedShapes shapes = shapes_of(static_cast<const Group&>(*content.root));
  std::vector<glm::vec3> vertices;
  for (const PlacedShapes::Each& each : shapes.all) {
    if (each.shape->mesh()->topology != Topology::points) return content.root;
    for (const glm::vec3& position : each.shape->mesh()->positions) {
      vertices.emplace_back(each.place * glm::dvec4(position, 1));
    }
  }
  return shapes.all.empty() ? content.root : from_mesh(mjcf_hull(asset, std::move(vertices)));
}

const MjcfHeights& MjcfAssets::heights(const MjcfElement& geom) {
  const std::string name = geom.text("hfield");
  const Tables& tables = tables_of(geom.model());
  const auto asset = tables.fields.find(name);
  if (asset == tables.fields.end()) geom.fail("shows the field of heights " + in_quotes(name) + ", which is not there");
  MjcfHeights& field = read_.fields[{&geom.model(), name}];
  if (field.mesh == nullptr) {
    HeightMap map = mjcf_height_map(asset->second);
    field = {pool_.intern(std::move(map.mesh)), map.place};
  }
  return field;
}

namespace {

// Blinn's exponent n of OpenGL is 128 times the shininess. The GGX distribution of alpha^2 = 2 / (n + 2) has the same
// width (Walter et al., Microfacet Models for Refraction, EGSR 2007), and roughness is the root of alpha.
float roughness_of(double shininess) {
  return static_cast<float>(std::pow(2 / (128 * std::clamp(shininess, 0.0, 1.0) + 2), 0.25));
}

void read_shine(const MjcfElement& asset, Material& material) {
  const double metallic = asset.number("metallic", -1), roughness = asset.number("roughness", -1);
  if (metallic >= 0) material.metallic = static_cast<float>(std::min(metallic, 1.0));
  if (roughness >= 0) material.roughness = static_cast<float>(std::min(roughness, 1.0));
  const bool is_given = asset.find("specular") || asset.find("shininess");
  if (metallic >= 0 || roughness >= 0 || !is_given || !(asset.number("specular", 0.5) > 0)) return;
  material.roughness = roughness_of(asset.number("shininess", 0.5));
}

}  // namespace

// Returns half the size that a texture covers; 0 along an infinite axis; none for meshes with texture coordinates.
std::optional<glm::dvec2> MjcfAssets::pictured_half_m(const MjcfElement& geom) {
  const std::string type = geom.text("type", "sphere");
  if (type == "plane") {
    const std::vector<double> size = geom.numbers("size", 1, 3);
    const auto half_m = [&](std::size_t i) { return i < size.size() && size[i] > 0 ? size[i] : 0; };
    return glm::dvec2(half_m(0), half_m(1));
  }
  if (type == "hfield") {
    const Tables& tables = tables_of(geom.model());
    const auto field = tables.fields.find(geom.text("hfield"));
    if (field == tables.fields.end()) return std::nullopt;
    const std::vector<double> size = field->second.numbers("size", 4, 4);
    return size.empty() ? std::nullopt : std::optional(glm::dvec2(size[0], size[1]));
  }
  if (type != "mesh") {
    if (geom.find("mesh")) return std::nullopt;  // it is fitted to a mesh, and has no sizes
    ModelShape shape;
    read_mjcf_solid(geom, type, shape);
    if (shape.kind == ModelShape::Kind::box) return glm::dvec2(shape.size) / 2.0;
    return shape.kind == ModelShape::Kind::ellipsoid ? glm::dvec2(shape.size) : glm::dvec2(shape.size.x);
  }
  const MjcfMesh& read = mesh(geom);
  if (read.shapes == nullptr) return std::nullopt;
  const PlacedShapes shapes = shapes_of(static_cast<const Group&>(*read.shapes));
  if (has_coordinates(shapes)) return std::nullopt;
  return glm::max(glm::dvec2(shapes.high - shapes.low) / 2.0, glm::dvec2(kMinPicture_m));
}

// A flat picture repeats as MuJoCo lets it since its version 3.12: `texrepeat` times over the coordinates of a shape,
// or, if it is `texuniform`, so often times half of the shape's length. On meshes without coordinates and fields of
// heights it is projected along z, with a corner of two pictures in the middle, and so it is on a plane along an axis
// without an end, where it repeats over each 2 m.
void MjcfAssets::lay_flat(const MjcfElement& asset, const MjcfElement& geom, Material& material, MjcfLook& look) {
  const std::string type = geom.text("type", "sphere");
  const std::optional<glm::dvec2> half_m = pictured_half_m(geom);
  const bool is_central = type == "mesh" || type == "hfield";
  const bool is_endless = type == "plane" && half_m && (half_m->x == 0 || half_m->y == 0);
  std::vector<double> repeat = asset.numbers("texrepeat", 2, 2);
  if (repeat.empty()) repeat = {1, 1};
  glm::vec2 count(1), start(0);
  for (int i = 0; i < 2; ++i) {
    double times = repeat[static_cast<std::size_t>(i)];
    if (half_m) {
      const double half = (*half_m)[i];
      if (half > 0 && asset.flag("texuniform", false)) times *= half;
      if (half == 0) times *= kDrawnPlane_m / 2;
      if (is_endless) start[i] = -0.5F;
      if (is_central || half == 0) start[i] = static_cast<float>(-(times + 1) / 2);
    }
    count[i] = static_cast<float>(times);
  }
  material.uv_transform = {count.x, 0, 0, count.y, start.x, start.y};
  if (type == "cylinder" || type == "capsule") material.uv_set = 1;  // see round_texture.h
  look.is_projected = half_m && type == "mesh";
  look.is_flat = true;
}

void MjcfAssets::add_picture(const MjcfElement& asset, const MjcfElement& geom, Material& material, MjcfLook& look) {
  const std::string name = asset.text("texture");
  if (name.empty()) return;
  const Tables& tables = tables_of(asset.model());
  const auto texture = tables.textures.find(name);
  if (texture == tables.textures.end()) {
    return report_.warn(asset.at(), "there is no texture " + in_quotes(name) + "; the material's colour replaces it");
  }
  const PictureUse use = material.alpha_mode == AlphaMode::opaque ? PictureUse::color : PictureUse::alpha;
  MjcfPicture read;
  try {
    read = mjcf_picture(texture->second, use, pool_, report_);
  } catch (const InputError& error) {
    report_.warn(without_word_error(error.what()) + "; the material's colour replaces it");
  }
  material.base_color_texture = read.picture;
  look.sides = read.sides;
  const std::string type = geom.text("type", "sphere");
  if (read.sides == CubeSides::none && read.picture != nullptr) lay_flat(asset, geom, material, look);
  if (read.sides != CubeSides::own || type == "box" || type == "mesh") return;
  report_.leave_out("difference between the sides of a cube texture on a round or flat shape", texture->second.at());
  material.uv_transform = glm::mat3x2(1, 0, 0, 1.0F / 6, 0, 0);
}

MjcfLook MjcfAssets::look_of(const MjcfElement& geom) {
  Material material;
  material.double_sided = true;
  const std::string name = geom.text("material");
  const Tables& tables = tables_of(geom.model());
  const auto asset = tables.materials.find(name);
  const bool has_asset = asset != tables.materials.end();
  if (!name.empty() && !has_asset) report_.warn(geom.at(), "there is no material " + in_quotes(name));
  auto rgba = geom.numbers("rgba", 3, 4);
  const bool is_default = rgba.empty() || std::equal(rgba.begin(), rgba.end(), kDefaultRgba.begin());
  if (is_default && has_asset) rgba = asset->second.numbers("rgba", 3, 4);
  if (rgba.empty() && has_asset) rgba = {1, 1, 1, 1};
  if (rgba.empty()) rgba.assign(kDefaultRgba.begin(), kDefaultRgba.end());
  material.base_color = linear_color(rgba);
  if (material.base_color.a < 1) material.alpha_mode = AlphaMode::blend;
  MjcfLook look;
  if (has_asset) {
    material.name = asset_name(asset->second);
    read_shine(asset->second, material);
    add_picture(asset->second, geom, material, look);
    material.emissive = glm::vec3(material.base_color) * static_cast<float>(asset->second.number("emission", 0));
    if (material.emissive != glm::vec3(0)) {
      material.map(MapKind::emissive).texture = material.base_color_texture;
      material.map(MapKind::emissive).uv_set = material.uv_set;
      material.map(MapKind::emissive).uv_transform = material.uv_transform;
    }
  }
  look.name = material.name;
  look.material = pool_.intern(std::move(material));
  return look;
}

}  // namespace simvis
