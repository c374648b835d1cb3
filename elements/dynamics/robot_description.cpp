#include "elements/dynamics/robot_description.h"

#include <algorithm>
#include <memory>

#include "dynamics/engine_module.h"
#include "dynamics/mass.h"
#include "dynamics/part_shapes.h"
#include "scenegraph/import/mesh/mesh_file.h"

namespace simvis {
namespace {

CollisionShape mesh_shape(const UrdfCollision& collision, ContentPool& pool) {
  const PartContent content =
      read_mesh_file(collision.file, MeshFileAxes::as_written, std::make_shared<const Material>(), pool);
  const auto root = std::dynamic_pointer_cast<const Group>(content.root);
  Triangles triangles = root == nullptr ? Triangles() : triangles_of(*root);
  for (glm::dvec3& point : triangles.points) point *= collision.size;
  if (std::optional<CollisionShape> hull = dynamics_engine().convex_hull(triangles.points)) return *std::move(hull);
  fail_at(collision.where,
          "collision mesh " + in_quotes(collision.file.string()) + " has no volume, expected a mesh that is not flat");
}

CollisionShape shape_of(const UrdfCollision& collision, ContentPool& pool) {
  CollisionShape shape;
  switch (collision.kind) {
    case UrdfCollision::Kind::box:
      shape = {.kind = CollisionKind::box, .half_m = collision.size / 2.0};
      break;
    case UrdfCollision::Kind::sphere:
      shape = {.kind = CollisionKind::sphere, .half_m = collision.size};
      break;
    case UrdfCollision::Kind::cylinder:
      shape = {.kind = CollisionKind::cylinder, .half_m = {collision.size.x, collision.size.x, collision.size.z / 2}};
      break;
    case UrdfCollision::Kind::mesh:
      shape = mesh_shape(collision, pool);
      break;
  }
  shape.body_from_shape = collision.link_from_shape;
  return shape;
}

// The link of the body that a link of the file belongs to: -1 is the base.
struct Anchor {
  int link = -1;
  glm::dmat4 anchor_from_link{1.0};
};

class Describer {
 public:
  Describer(const UrdfDynamics& urdf, ContentPool& pool) : urdf_(urdf), pool_(pool), anchors_(urdf.links.size()) {}

  RobotDescription run() {
    add_link(urdf_.links[0], anchors_[0]);
    for (const UrdfMovingJoint& joint : urdf_.joints) add(joint);
    for (RobotJoint& joint : robot_.joints) find_leader(joint);
    for (const RobotJoint& joint : robot_.joints) check_mass(joint);
    for (std::size_t i = 0; i < urdf_.links.size(); ++i)
      robot_.links.push_back({urdf_.links[i].name, anchors_[i].link});
    return std::move(robot_);
  }

 private:
  void add(const UrdfMovingJoint& joint) {
    const Anchor& parent = anchors_[joint.parent];
    Anchor& own = anchors_[joint.child];
    own = {parent.link, parent.anchor_from_link * joint.parent_from_joint};
    if (joint.kind != UrdfMovingJoint::Kind::fixed) {
      own = {static_cast<int>(robot_.body.links.size()), glm::dmat4(1)};
      robot_.joints.push_back({joint, robot_.body.links.size(), {}});
      robot_.body.links.push_back(moving_link(joint, parent));
    }
    add_link(urdf_.links[joint.child], own);
  }

  static LinkDesc moving_link(const UrdfMovingJoint& joint, const Anchor& parent) {
    if (joint.kind == UrdfMovingJoint::Kind::floating || joint.kind == UrdfMovingJoint::Kind::planar) {
      fail_at(joint.where, "joint " + in_quotes(joint.name) +
                               " is floating or planar, which physics does not move, expected a revolute, " +
                               "continuous, prismatic or fixed one");
    }
    LinkDesc link{.parent = parent.link, .parent_from_joint = parent.anchor_from_link * joint.parent_from_joint};
    link.joint = joint.kind == UrdfMovingJoint::Kind::prismatic ? JointKind::prismatic : JointKind::revolute;
    link.axis = joint.axis;
    if (joint.lower) link.lower = *joint.lower;
    if (joint.upper) link.upper = *joint.upper;
    link.damping = joint.damping;
    return link;
  }

  void add_link(const UrdfMovedLink& link, const Anchor& anchor) {
    const bool is_base = anchor.link < 0;
    LinkDesc* const to = is_base ? nullptr : &robot_.body.links[static_cast<std::size_t>(anchor.link)];
    MassProperties& mass = is_base ? robot_.body.mass : to->mass;
    std::vector<CollisionShape>& shapes = is_base ? robot_.body.shapes : to->shapes;
    if (link.inertial) {
      const MassProperties own{
          .mass_kg = link.inertial->mass_kg, .center_m = glm::dvec3(0), .inertia_kg_m2 = link.inertial->inertia_kg_m2};
      mass = sum_of(mass, moved(own, anchor.anchor_from_link * link.inertial->link_from_inertia));
    }
    for (const UrdfCollision& collision : link.collisions) {
      shapes.push_back(shape_of(collision, pool_));
      shapes.back().body_from_shape = anchor.anchor_from_link * shapes.back().body_from_shape;
    }
  }

  void find_leader(RobotJoint& joint) const {
    if (joint.urdf.leader.empty()) return;
    const auto leader = std::ranges::find_if(
        robot_.joints, [&](const RobotJoint& each) { return each.urdf.name == joint.urdf.leader; });
    if (leader != robot_.joints.end()) joint.leader = static_cast<std::size_t>(leader - robot_.joints.begin());
  }

  void check_mass(const RobotJoint& joint) const {
    const MassProperties& mass = robot_.body.links[joint.link].mass;
    if (mass.mass_kg > 0 && is_possible(principal_inertia(mass.inertia_kg_m2))) return;
    const UrdfMovedLink& link = urdf_.links[joint.urdf.child];
    fail_at(link.where, "link " + in_quotes(link.name) + " moves and has " +
                            (mass.mass_kg > 0 ? "an inertia that no body has" : "no mass") +
                            ", expected <inertial> with a mass and moments above 0 of which none is above the sum of " +
                            "the two others");
  }

  const UrdfDynamics& urdf_;
  ContentPool& pool_;
  std::vector<Anchor> anchors_;
  RobotDescription robot_;
};

}  // namespace

RobotDescription describe_robot(const UrdfDynamics& urdf, ContentPool& pool) { return Describer(urdf, pool).run(); }

}  // namespace simvis
