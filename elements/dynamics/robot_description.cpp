#include "elements/dynamics/robot_description.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "dynamics/engine_module.h"
#include "dynamics/mass.h"
#include "elements/dynamics/body_rows.h"
#include "import/mesh/mesh_file.h"

namespace simvis {
namespace {

CollisionShape surface_shape(Triangles triangles, const UrdfCollision& collision, MeshCollision as) {
  if (as == MeshCollision::triangles && !triangles.indices.empty()) return mesh_of(triangles);
  if (std::optional<CollisionShape> hull = dynamics_engine().convex_hull(triangles.points)) return *std::move(hull);
  fail_at(collision.where,
          "collision mesh " + in_quotes(collision.file.string()) + " has no volume, expected a mesh that is not flat");
}

Triangles surface_of(const UrdfCollision& collision, CollisionMeshes& meshes) {
  if (collision.kind == UrdfCollision::Kind::mesh) {
    Triangles triangles = meshes.read(collision.file);
    for (glm::dvec3& point : triangles.points) point *= collision.size;
    return triangles;
  }
  const Mesh& mesh = *collision.surface;
  return {.points = {mesh.positions.begin(), mesh.positions.end()}, .indices = mesh.indices};
}

CollisionShape geometry_of(const UrdfCollision& collision, MeshCollision as, CollisionMeshes& meshes) {
  const glm::dvec3 round(collision.size.x, collision.size.x, collision.size.z / 2);
  switch (collision.kind) {
    case UrdfCollision::Kind::box:
      return {.kind = CollisionKind::box, .half_m = collision.size / 2.0};
    case UrdfCollision::Kind::sphere:
      return {.kind = CollisionKind::sphere, .half_m = collision.size};
    case UrdfCollision::Kind::cylinder:
      return {.kind = CollisionKind::cylinder, .half_m = round};
    case UrdfCollision::Kind::capsule:
      return {.kind = CollisionKind::capsule, .half_m = round};
    case UrdfCollision::Kind::plane:
      return {.kind = CollisionKind::plane};
    case UrdfCollision::Kind::mesh:
    case UrdfCollision::Kind::surface:
      break;
  }
  return surface_shape(surface_of(collision, meshes), collision, as);
}

// The link of the body that a link of the file belongs to: -1 is the base.
struct Anchor {
  int link = -1;
  glm::dmat4 anchor_from_link{1.0};
};

class Describer {
 public:
  Describer(const UrdfDynamics& urdf, const RobotOptions& options, CollisionMeshes& meshes)
      : urdf_(urdf), options_(options), surface_(options.surface), meshes_(meshes), anchors_(urdf.links.size()) {}

  RobotDescription run() {
    robot_.body.surface = surface_.surface;
    add_link(urdf_.links[0], anchors_[0]);
    for (const UrdfMovingJoint& joint : urdf_.joints) add(joint);
    for (RobotJoint& joint : robot_.joints) find_leader(joint);
    for (const RobotJoint& joint : robot_.joints) check_mass(joint.urdf, joint.link, "moves");
    for (const RobotDescription::KeptJoint& joint : robot_.kept_joints) {
      const auto own = std::ranges::find(urdf_.joints, joint.name, &UrdfMovingJoint::name);
      check_mass(*own, joint.link, "stands behind a kept joint");
    }
    for (std::size_t i = 0; i < urdf_.links.size(); ++i)
      robot_.links.push_back({urdf_.links[i].name, anchors_[i].link});
    return std::move(robot_);
  }

 private:
  void add(const UrdfMovingJoint& joint) {
    const Anchor& parent = anchors_[joint.parent];
    Anchor& own = anchors_[joint.child];
    own = {parent.link, parent.anchor_from_link * joint.parent_from_joint};
    const bool moves = joint.kind != UrdfMovingJoint::Kind::fixed;
    if (moves || std::ranges::count(options_.kept_joints, joint.name) > 0) {
      const std::size_t link = robot_.body.links.size();
      own = {static_cast<int>(link), glm::dmat4(1)};
      if (moves) {
        robot_.joints.push_back({joint, link, {}});
      } else {
        robot_.kept_joints.push_back({joint.name, link});
      }
      robot_.body.links.push_back(moving_link(joint, parent));
      robot_.body.links.back().surface = surface_.surface;
    }
    add_link(urdf_.links[joint.child], own);
  }

  static JointKind kind_of(UrdfMovingJoint::Kind kind) {
    if (kind == UrdfMovingJoint::Kind::fixed) return JointKind::fixed;
    return kind == UrdfMovingJoint::Kind::prismatic ? JointKind::prismatic : JointKind::revolute;
  }

  static LinkDesc moving_link(const UrdfMovingJoint& joint, const Anchor& parent) {
    if (joint.kind == UrdfMovingJoint::Kind::floating || joint.kind == UrdfMovingJoint::Kind::planar) {
      fail_at(joint.where, "joint " + in_quotes(joint.name) +
                               " is floating or planar, which physics does not move, expected a revolute, " +
                               "continuous, prismatic or fixed one");
    }
    LinkDesc link{.parent = parent.link, .parent_from_joint = parent.anchor_from_link * joint.parent_from_joint};
    link.joint = kind_of(joint.kind);
    link.axis = joint.axis;
    if (joint.lower) link.lower = *joint.lower;
    if (joint.upper) link.upper = *joint.upper;
    link.damping = joint.damping;
    link.stiffness = joint.stiffness;
    link.rest = joint.rest;
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
      shapes.push_back(geometry_of(collision, options_.collision, meshes_));
      shapes.back().body_from_shape = anchor.anchor_from_link * collision.link_from_shape;
      shapes.back().surface = surface_of_file(collision);
    }
  }

  std::optional<SurfaceProperties> surface_of_file(const UrdfCollision& collision) const {
    SurfaceProperties own = surface_.surface;
    if (collision.friction && !surface_.friction_counts) own.friction = *collision.friction;
    if (collision.restitution && !surface_.restitution_counts) own.restitution = *collision.restitution;
    if (own == surface_.surface) return std::nullopt;
    return own;
  }

  void find_leader(RobotJoint& joint) const {
    if (joint.urdf.leader.empty()) return;
    const auto leader = std::ranges::find_if(
        robot_.joints, [&](const RobotJoint& each) { return each.urdf.name == joint.urdf.leader; });
    if (leader != robot_.joints.end()) joint.leader = static_cast<std::size_t>(leader - robot_.joints.begin());
  }

  void check_mass(const UrdfMovingJoint& joint, std::size_t moved, const char* does) const {
    const MassProperties& mass = robot_.body.links[moved].mass;
    if (mass.mass_kg > 0 && is_possible(principal_inertia(mass.inertia_kg_m2))) return;
    const UrdfMovedLink& link = urdf_.links[joint.child];
    fail_at(link.where, "link " + in_quotes(link.name) + " " + does + " and has " +
                            (mass.mass_kg > 0 ? "an inertia that no body has" : "no mass") +
                            ", expected <inertial> with a mass and moments above 0 of which none is above the sum of " +
                            "the two others");
  }

  const UrdfDynamics& urdf_;
  const RobotOptions& options_;
  const RobotSurface& surface_;
  CollisionMeshes& meshes_;
  std::vector<Anchor> anchors_;
  RobotDescription robot_;
};

}  // namespace

const Triangles& CollisionMeshes::read(const std::filesystem::path& file) {
  const auto known = read_.find(file);
  if (known != read_.end()) return known->second;
  const PartContent content = read_mesh_file(file, MeshFileAxes::as_written, std::make_shared<const Material>(), pool_);
  const auto root = std::dynamic_pointer_cast<const Group>(content.root);
  return read_.emplace(file, root == nullptr ? Triangles() : triangles_of(*root)).first->second;
}

RobotSurface read_robot_surface(const ElementContext& context) {
  return {.surface = read_surface(context.attributes),
          .friction_counts = context.command.find(kFrictionRow.name) != nullptr,
          .restitution_counts = context.command.find(kRestitutionRow.name) != nullptr};
}

RobotDescription describe_robot(const UrdfDynamics& urdf, const RobotOptions& options, CollisionMeshes& meshes) {
  return Describer(urdf, options, meshes).run();
}

}  // namespace simvis
