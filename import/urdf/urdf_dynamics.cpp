#include "import/urdf/urdf_dynamics.h"

#include <array>
#include <cmath>
#include <map>
#include <span>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/pose.h>
#include "import/model/package_files.h"

namespace simvis {
namespace {

// One element of the document with its place.
class Node {
 public:
  Node(const XmlText& text, pugi::xml_node node) : text_(&text), node_(node) {}
  explicit operator bool() const { return static_cast<bool>(node_); }
  Node child(const char* tag) const { return {*text_, node_.child(tag)}; }
  const pugi::xml_node& get() const { return node_; }
  const char* text(const char* attribute) const { return node_.attribute(attribute).value(); }
  Location where() const { return text_->at(node_); }

  [[noreturn]] void fail(const std::string& what) const { fail_at(where(), std::string(node_.name()) + " " + what); }

  // The numbers of an attribute; those given if it is missing.
  template <std::size_t count>
  std::array<double, count> numbers(const char* attribute, std::array<double, count> numbers) const {
    if (!node_ || !node_.attribute(attribute)) return numbers;
    if (parse_numbers(without_commas(text(attribute)), numbers)) return numbers;
    fail("has " + std::string(attribute) + " " + in_quotes(text(attribute)) + ", expected " + std::to_string(count) +
         (count == 1 ? " finite number" : " finite numbers"));
  }
  double number(const char* attribute, double absent) const { return numbers<1>(attribute, {absent})[0]; }
  double not_negative(const char* attribute) const {
    const double value = number(attribute, 0);
    if (value < 0) fail("has " + std::string(attribute) + " " + format_number(value) + ", expected at least 0");
    return value;
  }
  double above_zero(const char* attribute) const {
    const double value = number(attribute, 0);
    if (!(value > 0)) fail("has " + std::string(attribute) + " " + format_number(value) + ", expected more than 0");
    return value;
  }
  glm::dmat4 origin() const {
    const Node own = child("origin");
    const auto [x, y, z] = own.numbers<3>("xyz", {0, 0, 0});
    const auto [roll, pitch, yaw] = own.numbers<3>("rpy", {0, 0, 0});
    return to_matrix({.position_m = {x, y, z}, .roll_rad = roll, .pitch_rad = pitch, .yaw_rad = yaw});
  }

 private:
  const XmlText* text_;
  pugi::xml_node node_;
};

ModelInertial read_inertial(const Node& node) {
  const Node inertia = node.child("inertia");
  const double xx = inertia.number("ixx", 0), yy = inertia.number("iyy", 0), zz = inertia.number("izz", 0),
               xy = inertia.number("ixy", 0), xz = inertia.number("ixz", 0), yz = inertia.number("iyz", 0);
  return {.mass_kg = node.child("mass") ? node.child("mass").not_negative("value") : 0,
          .link_from_inertia = node.origin(),
          .inertia_kg_m2 = {{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}}};
}

ModelCollision read_collision(const Node& node, PackageFiles& packages) {
  ModelCollision collision;
  collision.link_from_shape = node.origin();
  collision.where = node.where();
  const Node geometry = node.child("geometry");
  if (const Node box = geometry.child("box")) {
    const auto [x, y, z] = box.numbers<3>("size", {0, 0, 0});
    if (!(std::min({x, y, z}) > 0)) box.fail("has a size that is not above 0");
    collision.size = {x, y, z};
  } else if (const Node sphere = geometry.child("sphere")) {
    collision.kind = ModelCollision::Kind::sphere;
    collision.size.x = sphere.above_zero("radius");
  } else if (const Node cylinder = geometry.child("cylinder")) {
    collision.kind = ModelCollision::Kind::cylinder;
    collision.size = {cylinder.above_zero("radius"), 0, cylinder.above_zero("length")};
  } else if (const Node capsule = geometry.child("capsule")) {
    collision.kind = ModelCollision::Kind::capsule;
    collision.size = {capsule.above_zero("radius"), 0, capsule.above_zero("length")};
  } else if (const Node mesh = geometry.child("mesh")) {
    collision.kind = ModelCollision::Kind::mesh;
    const auto [x, y, z] = mesh.numbers<3>("scale", {1, 1, 1});
    collision.size = {x, y, z};
    const auto file = packages.find(mesh.text("filename"), mesh.where());
    if (!file)
      mesh.fail("names " + in_quotes(mesh.text("filename")) + ", which is not there (" + packages.tried() + ")");
    collision.file = *file;
  } else {
    node.fail("has no box, sphere, cylinder, capsule or mesh");
  }
  return collision;
}

using LinksByName = std::map<std::string, ModelLink>;

LinksByName read_links(const XmlText& text, PackageFiles& packages) {
  LinksByName links;
  for (const pugi::xml_node& xml : text.document().child("robot").children("link")) {
    const Node node(text, xml);
    ModelLink link{.name = node.text("name"), .inertial = {}, .collisions = {}, .where = node.where()};
    if (const Node inertial = node.child("inertial")) link.inertial = read_inertial(inertial);
    for (const pugi::xml_node& collision : xml.children("collision")) {
      link.collisions.push_back(read_collision({text, collision}, packages));
    }
    links[link.name] = std::move(link);
  }
  return links;
}

using NodesByName = std::map<std::string, pugi::xml_node, std::less<>>;

NodesByName joint_nodes(const XmlText& text) {
  NodesByName joints;
  for (const pugi::xml_node& xml : text.document().child("robot").children("joint")) {
    joints.insert_or_assign(xml.attribute("name").value(), xml);
  }
  return joints;
}

void add_joint_dynamics(const Node& node, ModelJoint& joint) {
  joint.where = node.where();
  joint.max_effort = node.child("limit").not_negative("effort");
  joint.max_speed = node.child("limit").not_negative("velocity");
  joint.damping = node.child("dynamics").not_negative("damping");
  joint.friction = node.child("dynamics").not_negative("friction");
}

}  // namespace

// Mending has removed from the document what is wanted here, so that the text is parsed once more.
ModelDescription UrdfSource::describe(ContentPool& /*pool*/) {
  PackageFiles packages(request_.file, request_.packages);
  const XmlText text(file_.text.source());
  LinksByName links = read_links(text, packages);
  const NodesByName nodes = joint_nodes(text);
  ModelTree tree;
  struct Open {
    const urdf::Link* link;
    std::size_t parent;
  };
  std::vector<Open> open{{file_.robot->getRoot().get(), 0}};
  while (!open.empty()) {
    const auto [link, parent] = open.back();
    open.pop_back();
    const std::size_t index = tree.links.size();
    tree.links.push_back(links[link->name]);
    if (link->parent_joint) {
      ModelJoint joint = joints_.at(link->parent_joint->name);
      joint.parent = parent;
      joint.child = index;
      add_joint_dynamics({text, nodes.at(joint.name)}, joint);
      tree.joints.push_back(std::move(joint));
    }
    for (auto child = link->child_links.rbegin(); child != link->child_links.rend(); ++child) {
      open.push_back({child->get(), index});
    }
  }
  ModelDescription description;
  description.meshes = meshes_;
  description.where = {.file = file_.text.source().file()};
  description.bodies.push_back({.model = std::move(tree), .point = file_.robot->getRoot()->name});
  return description;
}

ModelWorld UrdfSource::world() {
  fail_at({.file = file_.text.source().file()},
          "a URDF file says nothing of gravity and steps, expected an SDF world or an MJCF model");
}

}  // namespace simvis
