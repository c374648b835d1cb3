#include "import/mjcf/mjcf_geoms.h"

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <simvis/pose.h>
#include "engine/base/read_fence.h"
#include "import/mesh/picture_file.h"
#include "import/mesh/shape_node.h"
#include "import/mjcf/mjcf_cube.h"
#include "import/mjcf/mjcf_solid.h"
#include "import/model/turn_z_to.h"
#include "scenegraph/primitive_meshes.h"

namespace simvis {
namespace {

constexpr double kFirstHiddenGroup = 3;

// The frame of a geom between two points: z from the first to the second.
glm::dmat4 pose_between(const MjcfElement& geom, const std::vector<double>& ends) {
  const glm::dvec3 from(ends[0], ends[1], ends[2]), to(ends[3], ends[4], ends[5]);
  if (from == to) geom.fail("has a \"fromto\" without length");
  glm::dmat4 pose(turn_z_to(to - from));
  pose[3] = glm::dvec4((from + to) / 2.0, 1);
  return pose;
}

// Each side of a box has the whole picture, as in MuJoCo: it goes along x and up z, along y and up z, or along x and up
// y, so that it is mirrored on three of them.
Mesh with_flat_pictures(Mesh box, const glm::dvec3& half_m) {
  for (std::size_t i = 0; i < box.positions.size(); ++i) {
    VertexAttributes& vertex = box.attributes[i];
    const int along = vertex.normal.x != 0 ? 1 : 0, up = vertex.normal.z != 0 ? 1 : 2;
    const glm::dvec3 place = glm::dvec3(box.positions[i]) / half_m;
    vertex.uv[0] = vertex.uv[1] = glm::vec2(0.5 + 0.5 * place[along], 0.5 - 0.5 * place[up]);
  }
  return box;
}

}  // namespace

glm::dmat4 mjcf_geom_pose(const MjcfElement& geom) {
  const std::vector<double> ends = geom.numbers("fromto", 6, 6);
  return ends.empty() ? mjcf_pose(geom) : pose_between(geom, ends);
}

std::optional<ReadScope> MjcfGeoms::scope_of_model(const std::filesystem::path& file) {
  const ModelFence fence(file);
  return read_scope();
}

NodePtr MjcfGeoms::make(const MjcfElement& geom) {
  std::optional<ReadFence> fence;
  if (scope_) fence.emplace(*scope_);
  try {
    NodePtr node = build(geom);
    if (node != nullptr) shown_.show();
    return node;
  } catch (const OutsideFolders& outside) {
    shown_.leave_out_outside(outside.file());
    return nullptr;
  } catch (const InputError& error) {
    const std::string why = without_word_error(error.what());
    shown_.leave_out(why);
    report_.warn(why + "; the geom is left out");
    return nullptr;
  }
}

NodePtr MjcfGeoms::build(const MjcfElement& geom) {
  if (geom.number("group", 0) >= kFirstHiddenGroup) return nullptr;
  const MjcfLook look = assets_.look_of(geom);
  if (look.material->base_color.a < kWhollyTransparent) return nullptr;
  const auto group = std::make_shared<Separator>();
  group->name = geom.written("name").value_or("");
  const std::string type = geom.text("type", "sphere");
  const glm::dmat4 pose = mjcf_geom_pose(geom);
  if (pose != glm::dmat4(1)) group->add(std::make_shared<Transform>(pose));
  const auto material = std::make_shared<MaterialNode>(look.material);
  material->name = look.name;
  group->add(material);
  add_shape(geom, type, look, *group);
  return group;
}

void MjcfGeoms::add_shape(const MjcfElement& geom, const std::string& type, const MjcfLook& look, Group& group) {
  if (type == "mesh") {
    if (geom.text("mesh").empty()) geom.fail("has no attribute \"mesh\"");
    const MjcfMesh& mesh = assets_.mesh(geom, look);
    if (mesh.shapes == nullptr) geom.fail("shows a mesh that cannot be read: " + mesh.error);
    return group.add(mesh.shapes);
  }
  if (type == "hfield") {
    const MjcfHeights& heights = assets_.heights(geom);
    group.add(std::make_shared<Transform>(heights.place));
    const auto shape = std::make_shared<Shape>(heights.mesh);
    shape->name = geom.text("hfield");
    return group.add(shape);
  }
  if (geom.find("mesh")) geom.fail("is a " + type + " that is fitted to a mesh, which is not taken over");
  if (type == "plane") {
    const std::vector<double> sizes = geom.numbers("size", 1, 3);
    const auto half = [&](std::size_t i) {
      return i < sizes.size() && sizes[i] > 0 ? sizes[i] : std::numeric_limits<double>::infinity();
    };
    return group.add(shape_node(endless_plane_mesh({half(0), half(1)}), pool_));
  }
  ModelShape shape;
  read_mjcf_solid(geom, type, shape);
  const bool has_own_picture = look.is_flat || look.sides != CubeSides::none;
  if (!has_own_picture || shape.kind != ModelShape::Kind::box) return add_shape_nodes(shape, shape_meshes_, group);
  const glm::dmat4 scale = exact_box_scale(shape.size);
  if (scale != glm::dmat4(1)) group.add(std::make_shared<Transform>(scale));
  Mesh box = box_mesh(shape.size);
  if (look.is_flat) return group.add(shape_node(with_flat_pictures(std::move(box), shape.size / 2.0), pool_));
  glm::dmat4 to_cube(1);
  for (int i = 0; i < 3; ++i) to_cube[i][i] = 2 / shape.size[i];
  group.add(shape_node(cube_textured(box, to_cube, look.sides), pool_));
}

}  // namespace simvis
