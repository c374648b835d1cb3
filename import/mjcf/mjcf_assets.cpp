#include "import/mjcf/mjcf_assets.h"

#include <strings.h>

#include <algorithm>
#include <array>
#include <glm/gtc/quaternion.hpp>
#include <system_error>
#include <utility>

#include <simvis/pose.h>
#include "engine/base/read_error.h"
#include "engine/base/srgb.h"
#include "import/mesh/mesh_file.h"
#include "import/mesh/picture_file.h"
#include "import/mjcf/mjcf_heights.h"
#include "import/mjcf/mjcf_mesh_data.h"
#include "scenegraph/graph_walk.h"

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

MjcfAssets::MjcfAssets(const MjcfModel& model, ImportReport& report, ContentPool& pool)
    : model_(model), report_(report), pool_(pool) {
  for (const MjcfElement& section : model.sections("asset")) {
    for (const MjcfElement& asset : section.children()) {
      if (asset.tag() == "mesh") {
        meshes_.emplace(asset_name(asset), asset);
      } else if (asset.tag() == "material") {
        materials_.emplace(asset_name(asset), asset);
      } else if (asset.tag() == "texture") {
        textures_.emplace(asset_name(asset), asset);
      } else if (asset.tag() == "hfield") {
        fields_.emplace(asset_name(asset), asset);
      } else {
        report_.leave_out("asset <" + std::string(asset.tag()) + ">", asset.at());
      }
    }
  }
}

const MjcfMesh& MjcfAssets::mesh(const std::string& name) {
  const auto [known, is_new] = read_meshes_.try_emplace(name);
  if (!is_new) return known->second;
  const auto asset = meshes_.find(name);
  if (asset == meshes_.end()) {
    known->second.error = "there is no mesh " + in_quotes(name);
    return known->second;
  }
  try {
    known->second = read_mesh(asset->second);
  } catch (const InputError& error) {
    known->second.error = without_word_error(error.what());
  }
  return known->second;
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
  const std::filesystem::path file = model_.asset_file(model_.mesh_folder, name);
  if (!is_input_file(file)) asset.fail("names a file that is not there: " + in_quotes(file.string()));
  if (::strcasecmp(file.extension().c_str(), ".msh") == 0) return from_mesh(read_msh_file(file));
  if (!is_mesh_file(file)) asset.fail("names " + in_quotes(file.string()) + ", expected .obj, .stl or .msh");
  PartContent content = read_mesh_file(file, MeshFileAxes::as_written, std::make_shared<const Material>(), pool_);
  for (std::string& warning : content.warnings) report_.warn(std::move(warning));
  return content.root;
}

const MjcfHeights& MjcfAssets::heights(const MjcfElement& geom) {
  const std::string name = geom.text("hfield");
  const auto asset = fields_.find(name);
  if (asset == fields_.end()) geom.fail("shows the field of heights " + in_quotes(name) + ", which is not there");
  MjcfHeights& field = read_fields_[name];
  if (field.mesh == nullptr) {
    HeightMap map = mjcf_height_map(asset->second, model_);
    field = {pool_.intern(std::move(map.mesh)), map.place};
  }
  return field;
}

std::shared_ptr<const Texture> MjcfAssets::picture_of(const MjcfElement& texture, Material& material) {
  const std::string name = texture.text("file"), type = texture.text("type", "cube");
  if (name.empty()) {
    const auto first = texture.numbers("rgb1", 3, 3);
    const std::vector<double> white = {0.8, 0.8, 0.8};  // MuJoCo's default of rgb1
    material.base_color *= linear_color(first.empty() ? white : first);
    report_.leave_out("built-in texture, whose first colour is shown,", texture.at());
    return nullptr;
  }
  if (type != "2d") {
    report_.leave_out("texture of type " + in_quotes(type), texture.at());
    return nullptr;
  }
  const std::filesystem::path file = model_.asset_file(model_.texture_folder, name);
  const auto read = [file, place = to_string(texture.at())](std::vector<std::string>& warnings) {
    std::optional<Texture> picture;
    try {
      picture = read_picture_file(file);
      picture->name = file.filename().string();
    } catch (const InputError& error) {
      warnings.push_back(place + ": " + without_word_error(error.what()) + "; the material's colour replaces it");
    }
    return picture;
  };
  std::vector<std::string> warnings;
  const PictureUse use = material.alpha_mode == AlphaMode::opaque ? PictureUse::color : PictureUse::alpha;
  auto picture = pool_.picture({.read = read, .use = use}, warnings);
  for (std::string& warning : warnings) report_.warn(std::move(warning));
  return picture;
}

void MjcfAssets::read_material(const MjcfElement& asset, Material& material) {
  material.name = asset_name(asset);
  const auto rgba = asset.numbers("rgba", 3, 4);
  material.base_color = rgba.empty() ? glm::vec4(1) : linear_color(rgba);
  if (material.base_color.a < 1) material.alpha_mode = AlphaMode::blend;
  material.emissive = glm::vec3(material.base_color) * static_cast<float>(asset.number("emission", 0));
  const double metallic = asset.number("metallic", -1), roughness = asset.number("roughness", -1);
  if (metallic >= 0) material.metallic = static_cast<float>(std::min(metallic, 1.0));
  if (roughness >= 0) material.roughness = static_cast<float>(std::min(roughness, 1.0));
  const std::string name = asset.text("texture");
  if (name.empty()) return;
  const auto texture = textures_.find(name);
  if (texture == textures_.end()) {
    report_.warn(asset.at(), "there is no texture " + in_quotes(name) + "; the material's colour replaces it");
    return;
  }
  material.base_color_texture = picture_of(texture->second, material);
  const auto repeat = asset.numbers("texrepeat", 2, 2);
  if (!repeat.empty()) {
    material.uv_transform = glm::mat3x2(static_cast<float>(repeat[0]), 0, 0, static_cast<float>(repeat[1]), 0, 0);
  }
}

std::shared_ptr<const Material> MjcfAssets::material_of(const MjcfElement& geom) {
  Material material;
  material.double_sided = true;
  const std::string name = geom.text("material");
  const auto asset = materials_.find(name);
  if (!name.empty() && asset == materials_.end()) {
    report_.warn(geom.at(), "there is no material " + in_quotes(name));
  }
  if (asset != materials_.end()) read_material(asset->second, material);
  auto rgba = geom.numbers("rgba", 3, 4);
  const bool is_default = rgba.empty() || std::equal(rgba.begin(), rgba.end(), kDefaultRgba.begin());
  if (!is_default || asset == materials_.end()) {
    if (rgba.empty()) rgba.assign(kDefaultRgba.begin(), kDefaultRgba.end());
    material.base_color = linear_color(rgba);
    material.alpha_mode = material.base_color.a < 1 ? AlphaMode::blend : AlphaMode::opaque;
  }
  return pool_.intern(std::move(material));
}

}  // namespace simvis
