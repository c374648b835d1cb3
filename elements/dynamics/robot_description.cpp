#include "elements/dynamics/robot_description.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <string_view>
#include <utility>

#include "elements/dynamics/body_rows.h"
#include "elements/dynamics/shapes_of_model.h"
#include "elements/dynamics/world/mass.h"
#include "engine/base/read_error.h"
#include "import/model/srdf_file.h"

namespace simvis {
namespace {

// The link of the body that a link of the file belongs to: -1 is the base.
struct Anchor {
  int link = -1;
  glm::dmat4 anchor_from_link{1.0};
};

class Describer {
 public:
  Describer(Scene& scene, const ModelTree& model, const RobotOptions& options, CollisionMeshes& meshes)
      : scene_(scene),
        model_(model),
        options_(options),
        surface_(options.surface),
        meshes_(meshes),
        anchors_(model.links.size()) {}

  RobotDescription run() {
    robot_.body.surface = surface_.surface;
    add_link(0);
    for (const ModelJoint& joint : model_.joints) add(joint);
    for (RobotJoint& joint : robot_.joints) find_leader(joint);
    if (options_.base_moves) check_mass(model_.links[0], robot_.body.mass, "moves");
    for (const RobotJoint& joint : robot_.joints) check_mass(joint.model, joint.link, "moves");
    for (const RobotDescription::KeptJoint& joint : robot_.kept_joints) {
      const auto own = std::ranges::find(model_.joints, joint.name, &ModelJoint::name);
      check_mass(*own, joint.link, "stands behind a kept joint");
    }
    for (std::size_t i = 0; i < model_.links.size(); ++i) {
      robot_.links.push_back({model_.links[i].name, anchors_[i].link, anchors_[i].anchor_from_link});
    }
    return std::move(robot_);
  }

 private:
  void add(const ModelJoint& joint) {
    const Anchor& parent = anchors_[joint.parent];
    Anchor& own = anchors_[joint.child];
    own = {parent.link, parent.anchor_from_link * joint.parent_from_joint};
    const bool moves = joint.kind != ModelJoint::Kind::fixed && !options_.is_static;
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
    add_link(joint.child);
  }

  static JointKind kind_of(ModelJoint::Kind kind) {
    if (kind == ModelJoint::Kind::fixed) return JointKind::fixed;
    if (kind == ModelJoint::Kind::ball) return JointKind::ball;
    return kind == ModelJoint::Kind::prismatic ? JointKind::prismatic : JointKind::revolute;
  }

  static LinkDesc moving_link(const ModelJoint& joint, const Anchor& parent) {
    if (joint.kind == ModelJoint::Kind::floating || joint.kind == ModelJoint::Kind::planar) {
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
    link.damps_new_speed = joint.damps_new_speed;
    link.stiffness = joint.stiffness;
    link.rest = joint.rest;
    link.rotor_inertia = joint.rotor_inertia;
    return link;
  }

  void add_link(std::size_t index) {
    const ModelLink& link = model_.links[index];
    const Anchor& anchor = anchors_[index];
    const bool is_base = anchor.link < 0;
    LinkDesc* const to = is_base ? nullptr : &robot_.body.links[static_cast<std::size_t>(anchor.link)];
    MassProperties& mass = is_base ? robot_.body.mass : to->mass;
    std::vector<CollisionShape>& shapes = is_base ? robot_.body.shapes : to->shapes;
    if (link.mass_bounds) {
      MassProperties own;
      add_mass(link, glm::dmat4(1), own);
      if (!link.inertial && link.solids.empty()) own.center_m = link.mass_bounds->center_of_empty_m;
      mass = sum_of(mass, moved(bounded(own, *link.mass_bounds), anchor.anchor_from_link));
    } else {
      add_mass(link, anchor.anchor_from_link, mass);
    }
    for (const ModelCollision& collision : link.collisions) {
      shapes.push_back(collision_shape_of(collision, options_.collision, meshes_));
      shapes.back().body_from_shape = anchor.anchor_from_link * collision.link_from_shape;
      shapes.back().surface = surface_of_file(collision);
      shapes.back().part = static_cast<int>(index);
    }
  }

  void add_mass(const ModelLink& link, const glm::dmat4& to_from_link, MassProperties& to) {
    if (link.inertial) {
      const MassProperties own{
          .mass_kg = link.inertial->mass_kg, .center_m = glm::dvec3(0), .inertia_kg_m2 = link.inertial->inertia_kg_m2};
      to = sum_of(to, moved(own, to_from_link * link.inertial->link_from_inertia));
    }
    for (const ModelSolid& solid : link.solids) {
      to = sum_of(to, moved(mass_of_solid(solid, meshes_), to_from_link * solid.link_from_shape));
    }
  }

  static MassProperties bounded(MassProperties mass, const ModelMassBounds& bounds) {
    mass.mass_kg = std::max(mass.mass_kg, bounds.min_mass_kg);
    PrincipalInertia inertia = principal_inertia(mass.inertia_kg_m2);
    glm::dvec3& moments = inertia.diagonal_kg_m2;
    moments = glm::max(moments, glm::dvec3(bounds.min_moment_kg_m2));
    const double sum = moments.x + moments.y + moments.z, largest = std::max({moments.x, moments.y, moments.z});
    if (bounds.balances_moments && largest > sum - largest) moments = glm::dvec3(sum / 3);
    mass.inertia_kg_m2 = inertia_of(inertia);
    return mass;
  }

  std::optional<SurfaceProperties> surface_of_file(const ModelCollision& collision) const {
    SurfaceProperties own = surface_.surface;
    if (collision.friction && !surface_.friction_counts) {
      own.friction = *collision.friction;
      own.larger_friction = collision.larger_friction;
    }
    if (collision.restitution && !surface_.restitution_counts) own.restitution = *collision.restitution;
    if (!surface_.mask_counts) own.mask = collision.mask;
    if (own == surface_.surface) return std::nullopt;
    return own;
  }

  void find_leader(RobotJoint& joint) {
    if (joint.model.leader.empty()) return;
    const auto leader = std::ranges::find_if(
        robot_.joints, [&](const RobotJoint& each) { return each.model.name == joint.model.leader; });
    if (leader == robot_.joints.end()) return;
    joint.leader = static_cast<std::size_t>(leader - robot_.joints.begin());
    if (!joint.model.is_coupled) return;
    robot_.body.coupled.push_back({.follower = joint.link,
                                   .leader = leader->link,
                                   .multiplier = joint.model.multiplier,
                                   .offset = joint.model.offset});
  }

  void check_mass(const ModelJoint& joint, std::size_t moved, const char* does) {
    MassProperties& mass = robot_.body.links[moved].mass;
    if (!(mass.mass_kg > 0) && model_.links[joint.child].is_between_joints && carries_next(moved)) return;
    check_mass(link_with_mass(joint, moved), mass, does);
  }

  // A format may put a link without a mass between a joint and the body of the file.
  const ModelLink& link_with_mass(const ModelJoint& joint, std::size_t moved) const {
    for (std::size_t i = 0; i < model_.links.size(); ++i) {
      const ModelLink& link = model_.links[i];
      if (anchors_[i].link == static_cast<int>(moved) && (link.inertial || !link.solids.empty())) return link;
    }
    return model_.links[joint.child];
  }

  // The mass of a link together with those behind fixed joints.
  void check_mass(const ModelLink& link, MassProperties& mass, const char* does) {
    if (!(mass.mass_kg > 0)) {
      fail_at(link.where, "link " + in_quotes(link.name) + " " + does +
                              " and has no mass, expected <inertial> with a mass above 0, or a link that stands");
    }
    correct_inertia(scene_, link.where, "link " + in_quotes(link.name), mass);
  }

  bool carries_next(std::size_t link) const {
    return std::ranges::count(robot_.body.links, static_cast<int>(link), &LinkDesc::parent) > 0;
  }

  Scene& scene_;
  const ModelTree& model_;
  const RobotOptions& options_;
  const RobotSurface& surface_;
  CollisionMeshes& meshes_;
  std::vector<Anchor> anchors_;
  RobotDescription robot_;
};

}  // namespace

void set_total_mass(std::span<RobotDescription> bodies, double mass_kg) {
  const auto visit = [&](const auto& change) {
    for (RobotDescription& each : bodies) {
      change(each.body.mass);
      for (LinkDesc& link : each.body.links) change(link.mass);
    }
  };
  double now_kg = 0;
  visit([&](const MassProperties& mass) { now_kg += mass.mass_kg; });
  if (!(now_kg > 0)) return;
  visit([&](MassProperties& mass) {
    if (mass.mass_kg > 0) mass = with_mass(mass, mass.mass_kg * mass_kg / now_kg);
  });
}

RobotSurface read_robot_surface(const ElementContext& context) {
  return {.surface = read_surface(context.attributes),
          .friction_counts = context.command.find(kFrictionName) != nullptr,
          .restitution_counts = context.command.find(kRestitutionName) != nullptr,
          .mask_counts = context.command.find(kCategoryBitmaskRow.name) != nullptr ||
                         context.command.find(kCollideBitmaskRow.name) != nullptr};
}

RobotDescription describe_robot(Scene& scene, const ModelTree& model, const RobotOptions& options,
                                CollisionMeshes& meshes) {
  return Describer(scene, model, options, meshes).run();
}

ModelContacts read_link_contacts(const ElementContext& context, const ModelDescription& file) {
  ModelContacts contacts = file.contacts;
  if (!context.attributes.is_set(kSrdfRow.name)) return contacts;
  const std::filesystem::path srdf =
      (context.command.folder / context.attributes.text(kSrdfRow.name)).lexically_normal();
  if (!is_input_file(srdf)) {
    fail_at(context.attributes.where(kSrdfRow.name),
            "attribute \"srdf\": there is no file " + in_quotes(srdf.string()));
  }
  std::vector<std::string_view> links;
  for (const ModelBody& body : file.bodies) {
    for (const ModelLink& link : body.model.links) links.push_back(link.name);
  }
  std::vector<std::string> warnings;
  std::ranges::move(read_srdf(srdf, links, warnings), std::back_inserter(contacts.apart));
  for (const std::string& warning : warnings) context.scene.warn(warning);
  contacts.links_collide = true;
  return contacts;
}

void set_link_contacts(const ModelContacts& contacts, RobotDescription& description) {
  if (!contacts.links_collide) return;
  description.body.links_collide = true;
  const auto parts_of = [&](const std::string& name, bool with_fixed) {
    std::vector<int> parts;
    const auto named = std::ranges::find(description.links, name, &RobotDescription::NamedLink::name);
    for (std::size_t i = 0; named != description.links.end() && i < description.links.size(); ++i) {
      const bool counts = with_fixed ? description.links[i].link == named->link : &description.links[i] == &*named;
      if (counts) parts.push_back(static_cast<int>(i));
    }
    return parts;
  };
  for (const ModelPair& pair : contacts.apart) {
    const std::vector<int> others = parts_of(pair.b, pair.with_fixed);
    for (const int a : parts_of(pair.a, pair.with_fixed)) {
      for (const int b : others) description.body.apart.push_back({a, b});
    }
  }
}

}  // namespace simvis
