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
#include "engine/base/srgb.h"
#include "import/mesh/mesh_file.h"
#include "import/mesh/picture_file.h"
#include "import/mjcf/mjcf_cube.h"
#include "import/mjcf/mjcf_heights.h"
#include "import/mjcf/mjcf_mesh_data.h"
#include "import/mjcf/mjcf_pictures.h"
#include "scenegraph/graph_walk.h"
#include "scenegraph/primitive_meshes.h"

namespace simvis {
namespace {

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

// Collects the shapes of a graph, each under its transform.
void add_shapes(const NodePtr& root, Group& group) {
  walk_graph(static_cast<const Group&>(*root),
             {.visit =
                  [&](const Node& node, const WalkState& state) {
                    if (node.kind() != NodeKind::shape) return;
                    const auto separator = std::make_shared<Separator>();
                    separator->add(std::make_shared<Transform>(state.world_from_node));
                    const auto shape = std::make_shared<Shape>(static_cast<const Shape&>(node).mesh());
                    shape->name = node.name;
                    separator->add(shape);
                    group.add(separator);
                  },
              .leave = {}});
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

const MjcfMesh& MjcfAssets::mesh(const MjcfElement& geom, CubeSides sides) {
  const MjcfReadAssets::Key key(&geom.model(), geom.text("mesh"));
  const auto [known, is_new] = read_.meshes.try_emplace(key);
  if (is_new) {
    const Tables& tables = tables_of(geom.model());
    const auto asset = tables.meshes.find(key.second);
    try {
      if (asset != tables.meshes.end()) known->second = read_mesh(asset->second);
      if (asset == tables.meshes.end()) known->second.error = "there is no mesh " + in_quotes(key.second);
    } catch (const InputError& error) {
      known->second.error = without_word_error(error.what());
    }
  }
  if (sides == CubeSides::none || known->second.shapes == nullptr) return known->second;
  const auto [textured, is_first] = read_.cube_meshes.try_emplace({key, sides});
  if (is_first) textured->second = cube_mesh(known->second, sides);
  return textured->second;
}

// The cube is as large as it is wide; how large does not matter.
MjcfMesh MjcfAssets::cube_mesh(const MjcfMesh& plain, CubeSides sides) {
  struct Placed {
    glm::dmat4 place;
    std::shared_ptr<const Mesh> mesh;
  };
  std::vector<Placed> shapes;
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
  const auto& root = static_cast<const Group&>(*plain.shapes);
  walk_graph(root, {.visit =
                        [&](const Node& node, const WalkState& state) {
                          if (node.kind() != NodeKind::shape) return;
                          shapes.push_back({state.world_from_node, static_cast<const Shape&>(node).mesh()});
                          for (const glm::vec3& position : shapes.back().mesh->positions) {
                            const glm::dvec3 at(state.world_from_node * glm::dvec4(position, 1));
                            low = glm::min(low, at);
                            high = glm::max(high, at);
                          }
                        },
                    .leave = {}});
  glm::dmat4 to_middle(1);
  if (low.x <= high.x) to_middle[3] = glm::dvec4(-(low + high) / 2.0, 1);
  const auto group = std::make_shared<Separator>();
  group->name = root.name;
  for (const Placed& each : shapes) {
    const auto separator = std::make_shared<Separator>();
    separator->add(std::make_shared<Transform>(each.place));
    const auto shape = std::make_shared<Shape>(pool_.intern(cube_textured(*each.mesh, to_middle * each.place, sides)));
    shape->name = each.mesh->name;
    separator->add(shape);
    group->add(separator);
  }
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
  add_shapes(content, *group);
  return {group, ""};
}

NodePtr MjcfAssets::read_mesh_content(const MjcfElement& asset) {
  const std::string name = asset.text("file");
  const auto from_mesh = [&](Mesh mesh) {
    const auto root = std::make_shared<Separator>();
    mesh.name = asset_name(asset);
    const auto shape = std::make_shared<Shape>(pool_.intern(std::move(mesh)));
    shape->name = shape->mesh()->name;
    root->add(shape);
    return root;
  };
  if (name.empty() && asset.find("vertex")) return from_mesh(inline_mjcf_mesh(asset));
  if (name.empty()) asset.fail("has neither \"file\" nor \"vertex\": built-in meshes are not taken over");
  const std::filesystem::path file = asset.model().asset_file(asset.model().mesh_folder, name);
  if (!is_input_file(file)) asset.fail("names a file that is not there: " + in_quotes(file.string()));
  if (::strcasecmp(file.extension().c_str(), ".msh") == 0) return from_mesh(read_msh_file(file));
  if (!is_mesh_file(file)) asset.fail("names " + in_quotes(file.string()) + ", expected .obj, .stl or .msh");
  PartContent content = read_mesh_file(file, MeshFileAxes::as_written, std::make_shared<const Material>(), pool_);
  for (std::string& warning : content.warnings) report_.warn(std::move(warning));
  return content.root;
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

// A picture repeats over a plane as MuJoCo lets it: `texrepeat` times over the whole plane, but over each 2 m if it is
// `texuniform` or has no end; in the middle of the plane is a corner of two pictures.
glm::mat3x2 repeats_of(const MjcfElement& material, const MjcfElement& geom) {
  std::vector<double> repeat = material.numbers("texrepeat", 2, 2);
  if (repeat.empty()) repeat = {1, 1};
  const std::vector<double> size = geom.numbers("size", 1, 3);
  glm::vec2 count(1), start(0);
  for (std::size_t i = 0; i < repeat.size(); ++i) {
    double times = repeat[i];
    const double half_m = i < size.size() && size[i] > 0 ? size[i] : 0;
    if (geom.text("type", "sphere") == "plane") {
      if (half_m == 0) times *= kDrawnPlane_m / 2;
      if (half_m > 0 && material.flag("texuniform", false)) times *= half_m;
      start[static_cast<int>(i)] = static_cast<float>(-(times + 1) / 2);
    }
    count[static_cast<int>(i)] = static_cast<float>(times);
  }
  return {count.x, 0, 0, count.y, start.x, start.y};
}

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

CubeSides MjcfAssets::add_picture(const MjcfElement& asset, const MjcfElement& geom, Material& material) {
  const std::string name = asset.text("texture");
  if (name.empty()) return CubeSides::none;
  const Tables& tables = tables_of(asset.model());
  const auto texture = tables.textures.find(name);
  if (texture == tables.textures.end()) {
    report_.warn(asset.at(), "there is no texture " + in_quotes(name) + "; the material's colour replaces it");
    return CubeSides::none;
  }
  const PictureUse use = material.alpha_mode == AlphaMode::opaque ? PictureUse::color : PictureUse::alpha;
  MjcfPicture read;
  try {
    read = mjcf_picture(texture->second, use, pool_, report_);
  } catch (const InputError& error) {
    report_.warn(without_word_error(error.what()) + "; the material's colour replaces it");
  }
  material.base_color_texture = read.picture;
  if (read.sides == CubeSides::none) material.uv_transform = repeats_of(asset, geom);
  const std::string type = geom.text("type", "sphere");
  if (read.sides != CubeSides::own || type == "box" || type == "mesh") return read.sides;
  report_.leave_out("difference between the sides of a cube texture on a round or flat shape", texture->second.at());
  material.uv_transform = glm::mat3x2(1, 0, 0, 1.0F / 6, 0, 0);
  return read.sides;
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
    look.sides = add_picture(asset->second, geom, material);
    material.emissive = glm::vec3(material.base_color) * static_cast<float>(asset->second.number("emission", 0));
    if (material.emissive != glm::vec3(0)) {
      material.map(MapKind::emissive).texture = material.base_color_texture;
      material.map(MapKind::emissive).uv_transform = material.uv_transform;
    }
  }
  look.name = material.name;
  look.material = pool_.intern(std::move(material));
  return look;
}

}  // namespace simvis
