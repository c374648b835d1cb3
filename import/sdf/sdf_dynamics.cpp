#include "import/sdf/sdf_dynamics.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/pose.h>
#include "import/mesh/picture_file.h"
#include "import/sdf/sdf_collisions.h"
#include "import/sdf/sdf_joints.h"

namespace simvis {
namespace {

double not_negative(const SdfElement& element, double fallback) {
  const double value = element.number(fallback);
  if (!(value >= 0) || std::isinf(value)) {
    element.fail("is " + format_number(value) + ", expected at least 0 and finite");
  }
  return value;
}

// A limit that SDF gives as a negative or infinite number is none.
double largest(const SdfElement& element) {
  const double value = element.number(0);
  return value > 0 && value < kSdfNoLimit ? value : 0;
}

const glm::dvec3 kSdfGravity_m_s2(0, 0, -9.8);

// The one that counts by default, else the first.
SdfElement physics_of(const SdfElement& world) {
  SdfElement found;
  for (const SdfElement& child : world.children()) {
    if (child.tag() != "physics") continue;
    const std::string is_default = child.attribute("default");
    if (!found || is_default == "true" || is_default == "1") found = child;
  }
  return found;
}

class SdfDescriber {
 public:
  explicit SdfDescriber(SdfDocument& document) : document_(document), sdf_(document.sdf) {}

  ModelDescription run() {
    ModelDescription description;
    for (const auto& link : document_.tree.links) {
      if (begins_body(*link)) description.bodies.push_back(read_body(*link));
    }
    description.is_world = !sdf_.is_single_model;
    description.meshes = document_.meshes;
    description.warnings = report_.release();
    description.where = sdf_.first.at();
    return description;
  }

 private:
  static bool is_static(const SdfLink& link) {
    for (const SdfScope* scope = link.scope; scope != nullptr; scope = scope->outer) {
      if (scope->is_static) return true;
    }
    return false;
  }

  // What moves at a static model hangs on the world.
  static bool begins_body(const SdfLink& link) {
    return link.parent == nullptr || (is_static(*link.parent) && !is_static(link));
  }

  // A link without mass that stands for the file's own frame.
  void add_anchor() {
    model_.links.push_back({.name = "", .inertial = {}, .collisions = {}, .where = sdf_.first.at()});
  }

  // A link that no other one moves, and all links behind it. A joint may hold it at the world.
  ModelBody read_body(const SdfLink& root) {
    is_static_ = is_static(root);
    const bool is_held = root.joint != nullptr;
    if (is_held) {
      add_anchor();
      add_all({{&root, 0, glm::dmat4(1)}});
    } else {
      model_.links.push_back(read_link(root));
      std::vector<Pending> open;
      push_followers(root, 0, open);
      add_all(std::move(open));
    }
    const SdfElement gravity = root.item->element.child("gravity");
    ModelBody body{.model = std::exchange(model_, {}),
                   .file_from_root = is_held ? glm::dmat4(1) : root.world_from_link,
                   .is_held = is_held,
                   .is_static = is_static_,
                   .point = is_held ? std::string() : root.point,
                   .has_weight = gravity.flag(true)};
    if (body.has_weight || body.stands() || body.model.links.size() == 1) return body;
    report_.leave_out("<gravity> 0 of a link with joints", gravity.at());
    body.has_weight = true;
    return body;
  }

  struct Pending {
    const SdfLink* link;
    std::size_t parent;
    glm::dmat4 world_from_parent;
  };

  static void push_followers(const SdfLink& link, std::size_t own, std::vector<Pending>& open) {
    for (auto each = link.followers.rbegin(); each != link.followers.rend(); ++each) {
      if (!begins_body(**each)) open.push_back({*each, own, link.world_from_link});
    }
  }

  void add_all(std::vector<Pending> open) {
    while (!open.empty()) {
      const Pending next = open.back();
      open.pop_back();
      push_followers(*next.link, add(next), open);
    }
  }

  // The joint, a link without mass in its frame, and the link itself. Returns the number of the latter.
  std::size_t add(const Pending& next) {
    std::size_t parent = next.parent;
    glm::dmat4 world_from_parent = next.world_from_parent;
    const bool moved = next.link->joint != nullptr && moves(*next.link);
    if (moved) {
      parent = add_joint(*next.link, parent, rigid_inverse(world_from_parent) * next.link->world_from_joint);
      world_from_parent = next.link->world_from_joint;
    }
    ModelJoint fixed{.name = moved ? std::string() : next.link->joint_name,
                     .parent = parent,
                     .child = model_.links.size(),
                     .parent_from_joint = rigid_inverse(world_from_parent) * next.link->world_from_link,
                     .where = next.link->item->element.at()};
    model_.links.push_back(read_link(*next.link));
    model_.joints.push_back(std::move(fixed));
    return model_.links.size() - 1;
  }

  // Of a world, a joint of another type holds its links together, as the importer says.
  bool moves(const SdfLink& link) const {
    const SdfElement& element = link.joint->element;
    if (element.attribute("type") == "fixed") return false;
    if (link.motion->kind != ModelJoint::Kind::fixed) return true;
    if (!sdf_.is_single_model || is_static_) return false;
    element.fail("has the type " + in_quotes(element.attribute("type")) +
                 ", which physics does not move, expected fixed, revolute, continuous, hinge or prismatic");
  }

  std::size_t add_joint(const SdfLink& link, std::size_t parent, const glm::dmat4& parent_from_joint) {
    const SdfElement& element = link.joint->element;
    ModelJoint joint = *link.motion;
    joint.parent = parent;
    joint.child = model_.links.size();
    joint.parent_from_joint = parent_from_joint;
    add_dynamics(element.child("axis"), joint);
    model_.links.push_back(
        {.name = link.joint_point + " (joint)", .inertial = {}, .collisions = {}, .where = element.at()});
    model_.joints.push_back(std::move(joint));
    return model_.links.size() - 1;
  }

  static void add_dynamics(const SdfElement& axis, ModelJoint& joint) {
    const SdfElement limit = axis.child("limit"), dynamics = axis.child("dynamics");
    joint.max_effort = largest(limit.child("effort"));
    joint.max_speed = largest(limit.child("velocity"));
    joint.damping = not_negative(dynamics.child("damping"), 0);
    joint.friction = not_negative(dynamics.child("friction"), 0);
    joint.stiffness = not_negative(dynamics.child("spring_stiffness"), 0);
    joint.rest = dynamics.child("spring_reference").number(0);
  }

  ModelLink read_link(const SdfLink& link) {
    const SdfElement& element = link.item->element;
    ModelLink read{.name = link.point, .inertial = {}, .collisions = {}, .where = element.at()};
    read.inertial = read_inertial(link);
    for (const SdfElement& child : element.children()) {
      if (child.tag() == "collision") add_collision(link, child, read.collisions);
    }
    return read;
  }

  ModelInertial read_inertial(const SdfLink& link) {
    const SdfElement inertial = link.item->element.child("inertial"), inertia = inertial.child("inertia");
    if (!inertial && !is_static_) {
      report_.warn(link.item->element.at(), "link " + in_quotes(link.item->name) +
                                                " has no <inertial>; it has what SDF gives it, 1 kg and 1 kg m^2");
    }
    const double xx = inertia.child("ixx").number(1), yy = inertia.child("iyy").number(1),
                 zz = inertia.child("izz").number(1), xy = inertia.child("ixy").number(0),
                 xz = inertia.child("ixz").number(0), yz = inertia.child("iyz").number(0);
    return {.mass_kg = not_negative(inertial.child("mass"), 1),
            .link_from_inertia = inertial ? sdf_place_in(link, inertial, document_.poses) : glm::dmat4(1),
            .inertia_kg_m2 = {{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}}};
  }

  // Of a world, a collision that is wrong is left out as a wrong visual is.
  void add_collision(const SdfLink& link, const SdfElement& element, std::vector<ModelCollision>& collisions) {
    try {
      auto collision =
          read_sdf_collision(element, sdf_place_in(link, element, document_.poses), document_.files, report_);
      if (collision && collision->kind == ModelCollision::Kind::plane && !is_static(link)) {
        return report_.leave_out("plane that collides and is not static", element.at());
      }
      if (collision) collisions.push_back(*std::move(collision));
    } catch (const InputError& error) {
      if (sdf_.is_single_model) throw;
      report_.warn(without_word_error(error.what()) + "; a collision of link " + in_quotes(link.item->name) +
                   " is left out");
    }
  }

  ImportReport report_;
  SdfDocument& document_;
  SdfContent& sdf_;
  ModelTree model_;
  bool is_static_ = false;
};

}  // namespace

ModelDescription SdfSource::describe(ContentPool& /*pool*/) { return SdfDescriber(*document_).run(); }

ModelWorld SdfSource::world() {
  const SdfContent& sdf = document_->sdf;
  if (sdf.first.tag() != "world") sdf.first.fail("has no <world>, expected one with gravity and steps");
  const SdfElement physics = physics_of(sdf.first), step = physics.child("max_step_size"),
                   iterations = physics.child("ode").child("solver").child("iters");
  ModelWorld read;
  // Up to SDF 1.5, gravity stands in <physics>.
  for (const SdfElement& in : {physics, sdf.first}) {
    if (const SdfElement gravity = in.child("gravity")) read.gravity_m_s2 = gravity.vector(kSdfGravity_m_s2);
  }
  if (step) read.step_s = step.number(0);
  if (step && !(*read.step_s >= kMinModelStep_s && *read.step_s <= kMaxModelStep_s)) {
    step.fail("is " + format_number(*read.step_s) + " s, expected a step from " + format_number(kMinModelStep_s) +
              " to " + format_number(kMaxModelStep_s) + " s");
  }
  if (iterations) read.iterations = static_cast<int>(std::clamp(iterations.number(0), 1.0, 10000.0));
  return read;
}

}  // namespace simvis
