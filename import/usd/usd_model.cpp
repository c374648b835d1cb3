#include "import/usd/usd_model.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/pose.h>
#include "import/gltf/gltf_importer.h"

namespace simvis {
namespace {

using nlohmann::json;

class UsdModelReader {
 public:
  UsdModelReader(GltfDocument& document, ContentPool& pool) : document_(document), pool_(pool) {
    where_.file = document.file.string();
  }

  ModelDescription run(const json& model) {
    ModelDescription file;
    file.where = where_;
    file.has_drives = true;
    for (const json& body : list(model, "bodies")) file.bodies.push_back(read_body(body));
    return file;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    document_.fail("the helper program that read it returned a model with " + what);
  }

  static const json& member(const json& object, const char* name) {
    static const json nothing;
    const auto found = object.is_object() ? object.find(name) : object.end();
    return object.is_object() && found != object.end() ? *found : nothing;
  }

  const json& list(const json& object, const char* name) const {
    const json& found = member(object, name);
    if (!found.is_array()) fail("no list " + in_quotes(name));
    return found;
  }

  double number(const json& value) const {
    if (!value.is_number()) fail("a value that is no number");
    const auto number = value.get<double>();
    if (!(std::abs(number) <= kMaxCoordinate_m)) fail("a number that is too large");
    return number;
  }

  double not_negative(const json& value) const {
    const double read = number(value);
    if (read < 0) fail("a mass, size or coefficient below 0");
    return read;
  }

  std::string text(const json& object, const char* name) const {
    const json& found = member(object, name);
    if (!found.is_string()) fail("no text " + in_quotes(name));
    return found.get<std::string>();
  }

  std::size_t index(const json& object, const char* name, std::size_t count) const {
    const json& found = member(object, name);
    if (!found.is_number_unsigned() || found.get<std::size_t>() >= count) fail("a wrong number " + in_quotes(name));
    return found.get<std::size_t>();
  }

  glm::dvec3 vector(const json& object, const char* name) const {
    const json& numbers = list(object, name);
    if (numbers.size() != 3) fail("no three numbers " + in_quotes(name));
    return {number(numbers[0]), number(numbers[1]), number(numbers[2])};
  }

  glm::dmat4 matrix(const json& object, const char* name) const {
    const json& numbers = list(object, name);
    if (numbers.size() != 16) fail("no matrix " + in_quotes(name));
    glm::dmat4 made;
    for (int i = 0; i < 16; ++i) made[i / 4][i % 4] = number(numbers[static_cast<std::size_t>(i)]);
    return made;
  }

  glm::dmat4 place(const json& object, const char* name) const {
    constexpr double kRounding = 1e-6;
    const glm::dmat4 made = matrix(object, name);
    if (!is_rigid(made, kRounding)) fail("a place that is not rigid");
    return made;
  }

  ModelBody read_body(const json& from) {
    ModelBody body;
    body.is_static = member(from, "static") == true;
    body.is_held = body.is_static || member(from, "held") == true;
    if (!body.is_held) body.point = text(from, "point");
    if (!body.is_static) body.file_from_root = place(from, "place");
    const json& links = list(from, "links");
    if (links.empty()) fail("a body without links");
    for (const json& link : links) body.model.links.push_back(read_link(link));
    std::set<std::size_t> moved{0};
    for (const json& joint : list(from, "joints")) read_joint(joint, links.size(), moved, body.model);
    if (moved.size() != links.size()) fail("a link that nothing holds");
    if (body.is_held && !body.is_static) move_anchor(body);
    return body;
  }

  // The anchor of a body that is held is the file's frame.
  static void move_anchor(ModelBody& body) {
    for (ModelJoint& joint : body.model.joints) {
      if (joint.parent == 0) joint.parent_from_joint = body.file_from_root * joint.parent_from_joint;
    }
    body.file_from_root = glm::dmat4(1);
  }

  ModelLink read_link(const json& from) {
    ModelLink link{.name = text(from, "name"), .inertial = {}, .collisions = {}, .where = where_};
    for (const json& each : list(from, "collisions")) {
      ModelCollision collision;
      collision.where = where_;
      read_shape(each, collision);
      if (!member(each, "friction").is_null()) collision.friction = not_negative(member(each, "friction"));
      if (!member(each, "restitution").is_null()) {
        collision.restitution = std::min(not_negative(member(each, "restitution")), 1.0);
      }
      link.collisions.push_back(std::move(collision));
    }
    if (const json& inertial = member(from, "inertial"); inertial.is_object()) {
      ModelInertial read{.mass_kg = not_negative(member(inertial, "mass")),
                         .link_from_inertia = place(inertial, "frame")};
      const glm::dvec3 moments = vector(inertial, "moments");
      for (int i = 0; i < 3; ++i) read.inertia_kg_m2[i][i] = moments[i];
      link.inertial = read;
    }
    if (member(from, "solids").is_array()) {
      for (const json& each : member(from, "solids")) {
        ModelSolid solid;
        solid.where = where_;
        read_shape(each, solid);
        solid.mass_kg = not_negative(member(each, "mass"));
        link.solids.push_back(std::move(solid));
      }
    }
    return link;
  }

  void read_shape(const json& from, ModelShape& shape) {
    static const std::map<std::string, ModelShape::Kind> kinds = {
        {"box", ModelShape::Kind::box},           {"sphere", ModelShape::Kind::sphere},
        {"cylinder", ModelShape::Kind::cylinder}, {"capsule", ModelShape::Kind::capsule},
        {"plane", ModelShape::Kind::plane},       {"mesh", ModelShape::Kind::nodes}};
    const auto kind = kinds.find(text(from, "kind"));
    if (kind == kinds.end()) fail("an unknown shape");
    shape.kind = kind->second;
    shape.link_from_shape = place(from, "matrix");
    shape.size = vector(from, "size");
    if (glm::any(glm::lessThan(shape.size, glm::dvec3(0)))) fail("a size below 0");
    if (shape.kind != ModelShape::Kind::nodes) return;
    const std::size_t mesh = index(from, "mesh", document_.model.meshes.size());
    const auto group = std::make_shared<Separator>();
    group->add(std::make_shared<Transform>(matrix(from, "stretch")));
    group->add(std::make_shared<Shape>(gltf_mesh(document_, mesh, pool_)));
    shape.nodes = group;
  }

  // A joint that moves turns a link without mass, and the link itself stands in that one as its frame says.
  void read_joint(const json& from, std::size_t links, std::set<std::size_t>& moved, ModelTree& model) {
    const std::size_t parent = index(from, "parent", links), child = index(from, "child", links);
    if (!moved.contains(parent) || !moved.insert(child).second) fail("joints that are no tree");
    const glm::dmat4 parent_from_joint = place(from, "parent_from_joint"),
                     joint_from_child = place(from, "joint_from_child");
    ModelJoint fixed;
    fixed.where = where_;
    fixed.child = child;
    const std::string kind = text(from, "kind");
    if (kind == "fixed") {
      fixed.parent = parent;
      fixed.parent_from_joint = parent_from_joint * joint_from_child;
      model.joints.push_back(std::move(fixed));
      return;
    }
    ModelJoint joint = read_moving(from, kind);
    joint.parent = parent;
    joint.child = model.links.size();
    joint.parent_from_joint = parent_from_joint;
    fixed.parent = joint.child;
    fixed.parent_from_joint = joint_from_child;
    model.links.push_back({.name = joint.name + " (joint)", .inertial = {}, .collisions = {}, .where = where_});
    model.links.back().is_between_joints = true;
    model.joints.push_back(std::move(joint));
    model.joints.push_back(std::move(fixed));
  }

  ModelJoint read_moving(const json& from, const std::string& kind) {
    ModelJoint joint;
    joint.where = where_;
    joint.name = text(from, "name");
    joint.kind = kind == "revolute"    ? ModelJoint::Kind::revolute
                 : kind == "prismatic" ? ModelJoint::Kind::prismatic
                                       : ModelJoint::Kind::ball;
    joint.damps_new_speed = true;
    const glm::dvec3 axis = vector(from, "axis");
    if (!(glm::length(axis) > 0)) fail("an axis without length");
    joint.axis = glm::normalize(axis);
    if (!member(from, "lower").is_null()) joint.lower = number(member(from, "lower"));
    if (!member(from, "upper").is_null()) joint.upper = number(member(from, "upper"));
    if (const json& drive = member(from, "drive"); drive.is_object()) joint.drive = read_drive(drive);
    return joint;
  }

  ModelDrive read_drive(const json& from) const {
    const double stiffness = not_negative(member(from, "stiffness")), damping = not_negative(member(from, "damping"));
    ModelDrive drive{.kind = stiffness > 0 ? ModelDrive::Kind::position : ModelDrive::Kind::velocity,
                     .gain = stiffness > 0 ? stiffness : damping,
                     .damping = damping};
    drive.start = number(member(from, stiffness > 0 ? "target" : "target_speed"));
    if (!member(from, "max_effort").is_null()) {
      drive.max_effort = not_negative(member(from, "max_effort"));
      drive.min_effort = -drive.max_effort;
    }
    return drive;
  }

  GltfDocument& document_;
  ContentPool& pool_;
  Location where_;
};

}  // namespace

ModelDescription read_usd_model(const json& model, GltfDocument& document, ContentPool& pool) {
  return UsdModelReader(document, pool).run(model);
}

}  // namespace simvis
