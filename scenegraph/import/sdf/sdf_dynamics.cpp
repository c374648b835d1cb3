#include "scenegraph/import/sdf/sdf_dynamics.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/pose.h>
#include "scenegraph/import/sdf/sdf_commands.h"
#include "scenegraph/import/sdf/sdf_mimic.h"
#include "scenegraph/import/sdf/sdf_reader.h"
#include "scenegraph/import/sdf/sdf_tree.h"

namespace simvis {
namespace {

double not_negative(const SdfElement& element, double fallback) {
  const double value = element.number(fallback);
  if (!(value >= 0) || std::isinf(value)) {
    element.fail("is " + format_number(value) + ", expected at least 0 and finite");
  }
  return value;
}

double above_zero(const SdfElement& element) {
  const double value = element.number(0);
  if (!(value > 0) || std::isinf(value)) {
    element.fail("is " + format_number(value) + ", expected more than 0 and finite");
  }
  return value;
}

// A limit that SDF gives as a negative or infinite number is none.
double largest(const SdfElement& element) {
  const double value = element.number(0);
  return value > 0 && value < kSdfNoLimit ? value : 0;
}

class DynamicsReader {
 public:
  explicit DynamicsReader(const ImportRequest& request) : files_(request.file, request.packages), request_(request) {}

  SdfDynamics run() {
    SdfReader(sdf_, files_, ignored_).read(request_.file);
    if (!sdf_.is_single_model) {
      sdf_.first.fail("is a world or one of several models, expected a file with one model for a robot of physics");
    }
    tree_ = make_sdf_tree(sdf_, poses_, names_, ignored_);
    result_.model.links.push_back({.name = "", .inertial = {}, .collisions = {}, .where = sdf_.first.at()});
    add_roots();
    result_.warnings = report_.release();
    return std::move(result_);
  }

 private:
  struct Pending {
    const SdfLink* link;
    std::size_t parent;
    glm::dmat4 world_from_parent;
  };

  void add_roots() {
    std::vector<Pending> open;
    const SdfLink* free_root = nullptr;
    for (const auto& link : tree_.links) {
      if (link->parent != nullptr) continue;
      if (link->joint == nullptr && free_root != nullptr) {
        link->item->element.fail(in_quotes(link->item->name) + " is not joined with " +
                                 in_quotes(free_root->item->name) + ", expected links that joints make one tree");
      }
      if (link->joint == nullptr) free_root = link.get();
      open.push_back({link.get(), 0, glm::dmat4(1)});
    }
    std::ranges::reverse(open);
    while (!open.empty()) {
      const Pending next = open.back();
      open.pop_back();
      const std::size_t own = add(next);
      const std::vector<SdfLink*>& followers = next.link->followers;
      for (auto each = followers.rbegin(); each != followers.rend(); ++each) {
        open.push_back({*each, own, next.link->world_from_link});
      }
    }
  }

  // The joint, a link without mass in its frame, and the link itself. Returns the number of the latter.
  std::size_t add(const Pending& next) {
    std::size_t parent = next.parent;
    glm::dmat4 world_from_parent = next.world_from_parent;
    if (next.link->joint != nullptr && next.link->joint->element.attribute("type") != "fixed") {
      parent = add_joint(*next.link, parent, rigid_inverse(world_from_parent) * next.link->world_from_joint);
      world_from_parent = next.link->world_from_joint;
    }
    UrdfMovingJoint fixed{.name = next.link->joint_name,
                          .parent = parent,
                          .child = result_.model.links.size(),
                          .parent_from_joint = rigid_inverse(world_from_parent) * next.link->world_from_link,
                          .where = next.link->item->element.at()};
    result_.model.links.push_back(read_link(*next.link));
    result_.model.joints.push_back(std::move(fixed));
    return result_.model.links.size() - 1;
  }

  std::size_t add_joint(const SdfLink& link, std::size_t parent, const glm::dmat4& parent_from_joint) {
    const SdfElement& element = link.joint->element;
    const bool turns = sdf_joint_turns(element);
    if (!turns && !sdf_joint_slides(element)) {
      element.fail("has the type " + in_quotes(element.attribute("type")) +
                   ", which physics does not move, expected fixed, revolute, continuous, hinge or prismatic");
    }
    UrdfMovingJoint joint{.kind = turns ? UrdfMovingJoint::Kind::revolute : UrdfMovingJoint::Kind::prismatic,
                          .name = link.joint_name,
                          .parent = parent,
                          .child = result_.model.links.size(),
                          .parent_from_joint = parent_from_joint,
                          .axis = axis_of(link),
                          .where = element.at()};
    read_axis(element.child("axis"), element.attribute("type") != "continuous", joint);
    if (const auto mimic = find_sdf_mimic(link, tree_, ignored_)) {
      joint.leader = mimic->leader;
      joint.multiplier = mimic->multiplier;
      joint.offset = mimic->offset;
    }
    result_.model.links.push_back(
        {.name = link.joint_point + " (joint)", .inertial = {}, .collisions = {}, .where = element.at()});
    result_.model.joints.push_back(std::move(joint));
    return result_.model.links.size() - 1;
  }

  glm::dvec3 axis_of(const SdfLink& link) {
    const SdfElement axis = link.joint->element.child("axis");
    const glm::dvec3 xyz = axis.child("xyz").vector(glm::dvec3(0, 0, 1));
    if (!(glm::length(xyz) > 0)) axis.fail("is 0 0 0, expected a vector that is not zero");
    return glm::normalize(glm::dmat3(sdf_joint_from_axis(link, poses_)) * xyz);
  }

  void read_axis(const SdfElement& axis, bool has_limits, UrdfMovingJoint& joint) {
    const SdfElement limit = axis.child("limit"), dynamics = axis.child("dynamics");
    const double lower = limit.child("lower").number(-kSdfNoLimit), upper = limit.child("upper").number(kSdfNoLimit);
    if (has_limits && lower <= upper) {
      if (lower > -kSdfNoLimit) joint.lower = lower;
      if (upper < kSdfNoLimit) joint.upper = upper;
    }
    joint.max_effort = largest(limit.child("effort"));
    joint.max_speed = largest(limit.child("velocity"));
    joint.damping = not_negative(dynamics.child("damping"), 0);
    joint.friction = not_negative(dynamics.child("friction"), 0);
    if (dynamics.child("spring_stiffness").number(0) != 0) {
      report_.leave_out("spring of a joint", dynamics.child("spring_stiffness").at());
    }
  }

  UrdfMovedLink read_link(const SdfLink& link) {
    const SdfElement& element = link.item->element;
    UrdfMovedLink read{.name = link.point, .inertial = {}, .collisions = {}, .where = element.at()};
    read.inertial = read_inertial(link);
    for (const SdfElement& child : element.children()) {
      if (child.tag() == "collision") add_collision(link, child, read.collisions);
    }
    return read;
  }

  UrdfInertial read_inertial(const SdfLink& link) {
    const SdfElement inertial = link.item->element.child("inertial"), inertia = inertial.child("inertia");
    if (!inertial) {
      report_.warn(link.item->element.at(), "link " + in_quotes(link.item->name) +
                                                " has no <inertial>; it has what SDF gives it, 1 kg and 1 kg m^2");
    }
    const double xx = inertia.child("ixx").number(1), yy = inertia.child("iyy").number(1),
                 zz = inertia.child("izz").number(1), xy = inertia.child("ixy").number(0),
                 xz = inertia.child("ixz").number(0), yz = inertia.child("iyz").number(0);
    return {.mass_kg = not_negative(inertial.child("mass"), 1),
            .link_from_inertia = inertial ? sdf_place_in(link, inertial, poses_) : glm::dmat4(1),
            .inertia_kg_m2 = {{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}}};
  }

  void add_collision(const SdfLink& link, const SdfElement& element, std::vector<UrdfCollision>& collisions) {
    const SdfElement geometry = element.child("geometry");
    UrdfCollision collision{.link_from_shape = sdf_place_in(link, element, poses_), .where = element.at()};
    if (const SdfElement box = geometry.child("box")) {
      collision.size = box.child("size").vector(glm::dvec3(1));
      if (!(std::min({collision.size.x, collision.size.y, collision.size.z}) > 0))
        box.fail("has a size that is not above 0");
    } else if (const SdfElement sphere = geometry.child("sphere")) {
      collision.kind = UrdfCollision::Kind::sphere;
      collision.size.x = above_zero(sphere.child("radius"));
    } else if (const SdfElement cylinder = geometry.child("cylinder")) {
      collision.kind = UrdfCollision::Kind::cylinder;
      collision.size = {above_zero(cylinder.child("radius")), 0, above_zero(cylinder.child("length"))};
    } else if (const SdfElement mesh = geometry.child("mesh")) {
      collision.kind = UrdfCollision::Kind::mesh;
      collision.size = mesh.child("scale").vector(glm::dvec3(1));
      if (mesh.child("submesh")) report_.leave_out("<submesh> of a collision, whose whole mesh counts", mesh.at());
      std::string why;
      const auto file = files_.find(mesh.child("uri") ? mesh.child("uri").text() : "", mesh, why);
      if (!file) mesh.fail("names a file that is not there: " + why);
      collision.file = *file;
    } else {
      const std::vector<SdfElement> kinds = geometry ? geometry.children() : std::vector<SdfElement>();
      const std::string kind = kinds.empty() ? "" : " <" + std::string(kinds.front().tag()) + ">";
      return report_.leave_out("collision with the geometry" + kind, element.at());
    }
    if (element.child("surface")) {
      report_.leave_out("<surface> of a collision; \"friction\" and \"restitution\" of the element robot count",
                        element.child("surface").at());
    }
    collisions.push_back(std::move(collision));
  }

  SdfReport report_, ignored_;  // the importer has told what stands in the latter
  SdfFiles files_;
  const ImportRequest& request_;
  SdfContent sdf_;
  SdfPoses poses_;
  SdfNames names_;
  SdfTree tree_;
  SdfDynamics result_;
};

}  // namespace

SdfDynamics read_sdf_dynamics(const ImportRequest& request) { return DynamicsReader(request).run(); }

}  // namespace simvis
