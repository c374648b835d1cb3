#include "import/mjcf/mjcf_geoms.h"

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <simvis/pose.h>
#include "import/mesh/picture_file.h"
#include "import/model/turn_z_to.h"
#include "scenegraph/primitive_meshes.h"

namespace simvis {
namespace {

constexpr double kFirstHiddenGroup = 3;

// The sizes of a geom; the length of one with `fromto` takes the place of its half length.
std::vector<double> sizes_of(const MjcfElement& geom, std::size_t count, const std::vector<double>& ends) {
  std::vector<double> sizes = geom.numbers("size", 1, 3);
  if (!ends.empty()) {
    const glm::dvec3 way(ends[3] - ends[0], ends[4] - ends[1], ends[5] - ends[2]);
    const double half = glm::length(way) / 2;
    // Of a box and an ellipsoid, the one size is that of both axes across.
    const double across = sizes.empty() ? 0 : sizes[0];
    sizes = count == 2 ? std::vector{across, half} : std::vector{across, across, half};
  }
  if (sizes.size() < count && !geom.unknown_class().empty()) {
    geom.fail("has no sizes, and the class " + in_quotes(geom.unknown_class()) + ", which no <default> defines");
  }
  if (sizes.size() < count)
    geom.fail("has " + std::to_string(sizes.size()) + " sizes, expected " + std::to_string(count));
  for (std::size_t i = 0; i < count; ++i) {
    if (!(sizes[i] > 0)) geom.fail("has a size that is not above 0");
  }
  return sizes;
}

// The frame of a geom between two points: z from the first to the second.
glm::dmat4 pose_between(const MjcfElement& geom, const std::vector<double>& ends) {
  const glm::dvec3 from(ends[0], ends[1], ends[2]), to(ends[3], ends[4], ends[5]);
  if (from == to) geom.fail("has a \"fromto\" without length");
  glm::dmat4 pose(turn_z_to(to - from));
  pose[3] = glm::dvec4((from + to) / 2.0, 1);
  return pose;
}

[[noreturn]] void fail_at_type(const MjcfElement& geom, const std::string& type) {
  geom.fail("is of type " + in_quotes(type) +
            ", which is not taken over, expected plane, sphere, capsule, ellipsoid, cylinder, box, mesh or hfield");
}

}  // namespace

glm::dmat4 mjcf_geom_pose(const MjcfElement& geom, const MjcfModel& model) {
  const std::vector<double> ends = geom.numbers("fromto", 6, 6);
  return ends.empty() ? mjcf_pose(geom, model) : pose_between(geom, ends);
}

MjcfSizes mjcf_sizes(const MjcfElement& geom, const std::string& type) {
  const std::vector<double> ends = geom.numbers("fromto", 6, 6);
  if (type == "sphere") return {ModelShape::Kind::sphere, {sizes_of(geom, 1, {})[0], 0, 0}};
  if (type == "capsule" || type == "cylinder") {
    const std::vector<double> sizes = sizes_of(geom, 2, ends);
    return {type == "capsule" ? ModelShape::Kind::capsule : ModelShape::Kind::cylinder, {sizes[0], 0, 2 * sizes[1]}};
  }
  if (type != "box" && type != "ellipsoid") fail_at_type(geom, type);
  const std::vector<double> sizes = sizes_of(geom, 3, ends);
  const glm::dvec3 half(sizes[0], sizes[1], sizes[2]);
  if (type == "box") return {ModelShape::Kind::box, 2.0 * half};
  return {ModelShape::Kind::ellipsoid, half};
}

NodePtr MjcfGeoms::make(const MjcfElement& geom) {
  try {
    NodePtr node = build(geom);
    has_any_ = has_any_ || node != nullptr;
    return node;
  } catch (const InputError& error) {
    const std::string why = without_word_error(error.what());
    if (first_left_out_.empty()) first_left_out_ = why;
    report_.warn(why + "; the geom is left out");
    return nullptr;
  }
}

void MjcfGeoms::require_any() const {
  if (has_any_ || first_left_out_.empty()) return;
  fail_at({.file = model_.file().string()}, "none of the model's geoms can be shown: " + first_left_out_);
}

NodePtr MjcfGeoms::build(const MjcfElement& geom) {
  if (geom.number("group", 0) >= kFirstHiddenGroup) return nullptr;
  const std::shared_ptr<const Material> material = assets_.material_of(geom);
  if (material->base_color.a < kWhollyTransparent) return nullptr;
  const auto group = std::make_shared<Separator>();
  group->name = geom.written("name").value_or("");
  const std::string type = geom.text("type", "sphere");
  const glm::dmat4 pose = mjcf_geom_pose(geom, model_);
  if (pose != glm::dmat4(1)) group->add(std::make_shared<Transform>(pose));
  const auto look = std::make_shared<MaterialNode>(material);
  look->name = material->name;
  group->add(look);
  if (type == "mesh") {
    add_mesh(geom, *group);
  } else if (type == "hfield") {
    const MjcfHeights& heights = assets_.heights(geom);
    group->add(std::make_shared<Transform>(heights.place));
    const auto shape = std::make_shared<Shape>(heights.mesh);
    shape->name = geom.text("hfield");
    group->add(shape);
  } else {
    add_shape(geom, type, *group);
  }
  return group;
}

void MjcfGeoms::add_mesh(const MjcfElement& geom, Group& group) {
  const std::string name = geom.text("mesh");
  if (name.empty()) geom.fail("has no attribute \"mesh\"");
  const MjcfMesh& mesh = assets_.mesh(name);
  if (mesh.shapes == nullptr) geom.fail("shows a mesh that cannot be read: " + mesh.error);
  group.add(mesh.shapes);
}

void MjcfGeoms::add_shape(const MjcfElement& geom, const std::string& type, Group& group) {
  const std::vector<double> ends = geom.numbers("fromto", 6, 6);
  const auto add = [&](Mesh mesh) {
    const auto shape = std::make_shared<Shape>(pool_.intern(std::move(mesh)));
    shape->name = shape->mesh()->name;
    group.add(shape);
  };
  if (geom.find("mesh")) geom.fail("is a " + type + " that is fitted to a mesh, which is not taken over");
  if (type == "sphere") return add(sphere_mesh(sizes_of(geom, 1, {})[0]));
  if (type == "capsule" || type == "cylinder") {
    const std::vector<double> sizes = sizes_of(geom, 2, ends);
    return add(type == "capsule" ? capsule_mesh(sizes[0], 2 * sizes[1]) : cylinder_mesh(sizes[0], 2 * sizes[1]));
  }
  if (type == "box") {
    const std::vector<double> sizes = sizes_of(geom, 3, ends);
    return add(box_mesh({2 * sizes[0], 2 * sizes[1], 2 * sizes[2]}));
  }
  if (type == "ellipsoid") {
    const std::vector<double> sizes = sizes_of(geom, 3, ends);
    group.add(
        std::make_shared<Transform>(glm::dmat4(sizes[0], 0, 0, 0, 0, sizes[1], 0, 0, 0, 0, sizes[2], 0, 0, 0, 0, 1)));
    return add(sphere_mesh(1));
  }
  if (type == "plane") {
    const std::vector<double> sizes = geom.numbers("size", 1, 3);
    const auto half = [&](std::size_t i) {
      return i < sizes.size() && sizes[i] > 0 ? sizes[i] : std::numeric_limits<double>::infinity();
    };
    return add(endless_plane_mesh({half(0), half(1)}));
  }
  fail_at_type(geom, type);
}

}  // namespace simvis
