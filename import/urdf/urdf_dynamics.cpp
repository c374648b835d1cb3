#include "import/urdf/urdf_dynamics.h"

#include <algorithm>
#include <utility>

#include <simvis/attributes.h>
#include "import/model/package_files.h"

namespace simvis {
namespace {

ModelInertial read_inertial(const UrdfElement& node) {
  const UrdfElement inertia = node.child("inertia");
  const double xx = inertia.number("ixx", 0), yy = inertia.number("iyy", 0), zz = inertia.number("izz", 0),
               xy = inertia.number("ixy", 0), xz = inertia.number("ixz", 0), yz = inertia.number("iyz", 0);
  return {.mass_kg = node.child("mass") ? node.child("mass").not_negative("value") : 0,
          .link_from_inertia = node.origin(),
          .inertia_kg_m2 = {{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}}};
}

ModelCollision read_collision(const UrdfElement& node, PackageFiles& packages) {
  ModelCollision collision{{read_urdf_shape(node)}};
  collision.where = node.where();
  const UrdfElement shape = node.child("geometry").first_child();
  if (collision.kind != ModelShape::Kind::mesh) {
    if (std::min({collision.size.x, collision.size.y, collision.size.z}) > 0) return collision;
    shape.fail("has a size that is not above 0");
  }
  const std::string name = shape.text("filename");
  const auto file = packages.find(name, shape.where());
  if (!file) shape.fail("names " + in_quotes(name) + ", which is not there (" + packages.tried() + ")");
  collision.file = *file;
  return collision;
}

ModelLink read_link(const UrdfLink& link, PackageFiles& packages) {
  ModelLink read{.name = link.name, .inertial = {}, .collisions = {}, .where = link.element.where()};
  if (const UrdfElement inertial = link.element.child("inertial")) read.inertial = read_inertial(inertial);
  for (const UrdfElement& each : link.element.children("collision")) {
    read.collisions.push_back(read_collision(each, packages));
  }
  return read;
}

ModelJoint read_joint(const UrdfJoint& joint) {
  ModelJoint read = joint.model;
  const UrdfElement limit = joint.element.child("limit"), dynamics = joint.element.child("dynamics");
  read.max_effort = limit.not_negative("effort");
  read.max_speed = limit.not_negative("velocity");
  read.damping = dynamics.not_negative("damping");
  read.friction = dynamics.not_negative("friction");
  return read;
}

}  // namespace

ModelDescription UrdfSource::describe(ContentPool& /*pool*/) {
  PackageFiles packages(request_.file, request_.packages);
  ModelTree tree;
  for (const UrdfLink& each : file_.links) tree.links.push_back(read_link(each, packages));
  for (const UrdfJoint& each : file_.joints) tree.joints.push_back(read_joint(each));
  ModelDescription description;
  description.meshes = meshes_;
  description.where = {.file = file_.text->source().file()};
  description.bodies.push_back({.model = std::move(tree), .point = file_.links.front().name});
  return description;
}

ModelWorld UrdfSource::world() {
  fail_at({.file = file_.text->source().file()},
          "a URDF file says nothing of gravity and steps, expected an SDF world or an MJCF model");
}

}  // namespace simvis
