#include "import/sdf/sdf_visuals.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <initializer_list>
#include <limits>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/part_importer.h>
#include <simvis/pose.h>
#include "engine/base/read_fence.h"
#include "import/mesh/picture_file.h"
#include "import/mesh/shape_node.h"
#include "import/sdf/sdf_geometry.h"
#include "scenegraph/clone_graph.h"
#include "scenegraph/graph_walk.h"
#include "scenegraph/language/other_kinds.h"
#include "scenegraph/primitive_meshes.h"

namespace simvis {
namespace {

bool has_group(const Group& root, const std::string& name) {
  bool found = false;
  walk_graph(root, {.visit =
                        [&](const Node& node, const WalkState&) {
                          found = found || (dynamic_cast<const Group*>(&node) != nullptr && node.name == name);
                        },
                    .leave = {}});
  return found;
}

// Keeps the shapes of a graph that stand in a node of the name, each under its transform; if no node has it, the shapes
// that have it themselves.
NodePtr submesh_of(const Group& root, const std::string& name, bool center) {
  struct Kept {
    glm::dmat4 place;
    const MaterialNode* material;
    const Shape* shape;
  };
  std::vector<Kept> kept;
  int within = 0;
  const bool is_group_named = has_group(root, name);
  walk_graph(root, {.visit =
                        [&](const Node& node, const WalkState& state) {
                          const bool is_group = dynamic_cast<const Group*>(&node) != nullptr;
                          if (is_group && (within > 0 || node.name == name)) ++within;
                          if (node.kind() != NodeKind::shape || (within == 0 && (is_group_named || node.name != name)))
                            return;
                          kept.push_back({state.world_from_node, state.material, static_cast<const Shape*>(&node)});
                        },
                    .leave =
                        [&](const Group&) {
                          if (within > 0) --within;
                        }});
  if (kept.empty()) return nullptr;
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
  for (const Kept& each : kept) {
    for (const glm::vec3& position : each.shape->mesh()->positions) {
      const glm::dvec3 at(each.place * glm::dvec4(position, 1));
      low = glm::min(low, at);
      high = glm::max(high, at);
    }
  }
  const auto group = std::make_shared<Separator>();
  group->name = name;
  if (center && low.x <= high.x) {
    glm::dmat4 matrix(1);
    matrix[3] = glm::dvec4(-(low + high) / 2.0, 1);
    group->add(std::make_shared<Transform>(matrix));
  }
  for (const Kept& each : kept) {
    const auto separator = std::make_shared<Separator>();
    separator->add(std::make_shared<Transform>(each.place));
    if (each.material != nullptr) separator->add(std::make_shared<MaterialNode>(each.material->material()));
    const auto shape = std::make_shared<Shape>(each.shape->mesh());
    shape->name = each.shape->name;
    separator->add(shape);
    group->add(separator);
  }
  return group;
}

// Gazebo's lidars give <laser_retro> as the intensity of a surface; here it is the gain of a retro-reflector.
float retro_reflectance_of(const SdfElement& visual) {
  constexpr double kMaxGain = 1e9;
  const SdfElement retro = visual.child("laser_retro");
  const double gain = retro.number(0);
  if (!(gain >= 0 && gain <= kMaxGain)) {
    retro.fail("is " + format_number(gain) + ", expected a number from 0 to " + format_number(kMaxGain));
  }
  return static_cast<float>(gain);
}

}  // namespace

NodePtr SdfVisuals::make(const SdfElement& visual, const std::string& link,
                         const std::function<glm::dmat4()>& link_from_visual) {
  try {
    NodePtr node = build(visual, link_from_visual());
    if (node != nullptr) shown_.show();
    return node;
  } catch (const OutsideFolders& outside) {
    shown_.leave_out_outside(outside.file());
    return nullptr;
  } catch (const InputError& error) {
    const std::string why = without_word_error(error.what());
    shown_.leave_out(why);
    report_.warn(why + "; a visual of link " + in_quotes(link) + " is left out");
    return nullptr;
  }
}

NodePtr SdfVisuals::build(const SdfElement& visual, const glm::dmat4& link_from_visual) {
  const std::vector<SdfElement> shapes =
      visual.child("geometry") ? visual.child("geometry").children() : std::vector<SdfElement>();
  if (shapes.empty()) report_.warn(visual.at(), "the visual has no geometry and is left out");
  if (shapes.empty() || shapes.front().tag() == "empty") return nullptr;
  // Several polylines are an outline and its holes.
  if (shapes.size() > 1 && shapes[1].tag() == "polyline") shapes[1].fail("is a hole, which is not taken over");
  const double transparency = visual.child("transparency").number(0);
  if (!(transparency >= 0 && transparency <= 1)) visual.fail("has a <transparency> outside 0 to 1");
  const std::string name = visual.attribute("name");
  const auto separator = std::make_shared<Separator>();
  separator->name = name;
  if (link_from_visual != glm::dmat4(1)) separator->add(std::make_shared<Transform>(link_from_visual));
  const SdfLook look{.opacity = 1 - transparency, .retro_reflectance = retro_reflectance_of(visual)};
  std::shared_ptr<const Material> material = materials_.read(visual.child("material"), name, look.opacity);
  if (material != nullptr && look.retro_reflectance > 0) {
    Material reflecting = *material;
    reflecting.retro_reflectance = look.retro_reflectance;
    material = pool_.intern(std::move(reflecting));
  }
  add_geometry(shapes.front(), material, look, *separator);
  if (!visual.child("cast_shadows").flag(true)) report_.leave_out("<cast_shadows> 0 of a visual", visual.at());
  return separator;
}

std::shared_ptr<const Material> SdfVisuals::plain_of(const SdfLook& look) {
  Material plain = SdfMaterials::plain(look.opacity);
  plain.retro_reflectance = look.retro_reflectance;
  return pool_.intern(std::move(plain));
}

void SdfVisuals::add_geometry(const SdfElement& shape, const std::shared_ptr<const Material>& material,
                              const SdfLook& look, Group& group) {
  const std::string_view tag = shape.tag();
  if (tag == "mesh") return add_mesh(shape, material, look, group);
  if (tag == "heightmap") return add_heightmap(shape, material, look, group);
  group.add(std::make_shared<MaterialNode>(material ? material : plain_of(look)));
  ModelShape solid;
  if (read_sdf_solid(shape, solid)) return add_shape_nodes(solid, shape_meshes_, group);
  if (tag != "plane") {
    shape.fail(
        "is not taken over, expected box, sphere, cylinder, capsule, cone, ellipsoid, plane, heightmap, polyline "
        "or mesh");
  }
  group.add(std::make_shared<Transform>(sdf_plane_turn(shape)));
  group.add(shape_node(plane_mesh(sdf_sizes(shape, "size", glm::dvec2(1))), pool_));
}

void SdfVisuals::add_heightmap(const SdfElement& map, const std::shared_ptr<const Material>& material,
                               const SdfLook& look, Group& group) {
  const SdfElement texture = map.child("texture");
  HeightMap surface = sdf_height_map(map, files_);
  const glm::dmat4 place = glm::translate(glm::dmat4(1), map.child("pos").vector(glm::dvec3(0))) * surface.place;
  if (place != glm::dmat4(1)) group.add(std::make_shared<Transform>(place));
  const bool is_textured = texture && texture.child("diffuse") && material == nullptr;
  group.add(std::make_shared<MaterialNode>(
      is_textured ? materials_.of_heightmap(texture, glm::dvec2(sdf_height_map_size(map)), look.opacity)
                  : (material ? material : plain_of(look))));
  group.add(shape_node(std::move(surface.mesh), pool_));
}

void SdfVisuals::add_mesh(const SdfElement& mesh, const std::shared_ptr<const Material>& material, const SdfLook& look,
                          Group& group) {
  const SdfElement submesh = mesh.child("submesh");
  ModelShape read;
  read_sdf_mesh(mesh, files_, read);
  const SdfElement name = submesh.child("name");
  const NodePtr content = read_mesh(mesh, {.file = read.file,
                                           .submesh = name ? name.text() : std::string(),
                                           .center = submesh.child("center").flag(false),
                                           .material = material,
                                           .look = look});
  if (read.size != glm::dvec3(1)) {
    glm::dmat4 matrix(1);
    for (int i = 0; i < 3; ++i) matrix[i][i] = read.size[i];
    group.add(std::make_shared<Transform>(matrix));
  }
  group.add(content);
}

NodePtr SdfVisuals::read_mesh(const SdfElement& mesh, const MeshKey& key) {
  const auto known = changed_meshes_.find(key);
  if (known != changed_meshes_.end()) return known->second;
  NodePtr content = read_file(key.file, mesh);
  if (!key.submesh.empty()) {
    content = submesh_of(static_cast<const Group&>(*content), key.submesh, key.center);
    if (content == nullptr) mesh.fail("names the submesh " + in_quotes(key.submesh) + ", which the file does not have");
  } else if (key.material != nullptr || key.look != SdfLook()) {
    NodeMap clone_of;
    content = clone_graph(content, clone_of);
  }
  for (const NodePtr& node : nodes_of(content)) {
    if (node->kind() != NodeKind::material) continue;
    auto& look = static_cast<MaterialNode&>(*node);
    if (key.material != nullptr) {
      look.set_material(key.material);
    } else if (key.look != SdfLook()) {
      Material changed = *look.material();
      changed.opacity *= static_cast<float>(key.look.opacity);
      if (key.look.retro_reflectance > 0) changed.retro_reflectance = key.look.retro_reflectance;
      look.set_material(pool_.intern(std::move(changed)));
    }
  }
  changed_meshes_.emplace(key, content);
  return content;
}

GroupPtr SdfVisuals::read_file(const std::filesystem::path& file, const SdfElement& mesh) {
  if (!ModelMeshes::is_known(file)) {
    mesh.fail("names " + in_quotes(file.string()) + ", which is of an unknown kind, expected " + kModelMeshEndings +
              converter_of(file));
  }
  GroupPtr content = meshes_.read(file, axes_, plain_, pool_);
  for (std::string& warning : meshes_.release_warnings()) report_.warn(std::move(warning));
  return content;
}

}  // namespace simvis
