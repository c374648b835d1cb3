#include "import/mjcf/mjcf_dynamics.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/pose.h>
#include "import/mesh/picture_file.h"
#include "import/mjcf/mjcf_actuators.h"
#include "import/mjcf/mjcf_equality.h"
#include "import/mjcf/mjcf_geoms.h"
#include "import/mjcf/mjcf_inertia.h"

namespace simvis {
namespace {

// What MuJoCo has where a model gives nothing.
constexpr double kMjcfStep_s = 0.002;
const glm::dvec3 kMjcfGravity_m_s2(0, 0, -9.81);

class MjcfDescriber {
 public:
  MjcfDescriber(const MjcfTree& tree, ContentPool& pool)
      : tree_(tree),
        model_(tree.model()),
        assets_(*tree.assets, ignored_, pool),
        shapes_(tree.model(), assets_, report_),
        drives_(model_.is_off("actuation") ? std::map<std::string, ModelDrive>() : read_mjcf_drives(tree, report_)),
        place_(tree.bodies.size()) {}

  ModelDescription run() {
    report_options();
    file_.has_drives = file_.contacts.links_collide = true;
    file_.where = {.file = model_.file().string()};
    file_.bodies.push_back(anchored(tree_.bodies[0].element.at()));
    file_.bodies.back().is_static = true;
    add_content(tree_.bodies[0], file_.bodies[0].model.links[0]);
    for (std::size_t i = 1; i < tree_.bodies.size(); ++i) add_body(i);
    for (const MjcfElement& compiler : model_.sections("compiler")) {
      if (const double mass = compiler.number("settotalmass", 0); mass > 0) file_.total_mass_kg = mass;
    }
    if (!model_.is_off("equality")) read_mjcf_equalities(tree_, file_, report_);
    read_excludes();
    for (const auto& [joint, drive] : drives_) {
      if (known_joints_.contains(joint)) continue;
      // An attached model may bring only some of its bodies.
      const bool is_attached = std::ranges::any_of(tree_.members, [&, &name = joint](const MjcfMember& member) {
        return !member.prefix.empty() && name.starts_with(member.prefix);
      });
      if (!is_attached) {
        report_.warn("actuator of joint " + in_quotes(joint) + ", which is not there or is no hinge or slide");
      }
    }
    file_.warnings = report_.release();
    return std::move(file_);
  }

 private:
  // Where a body of the file is in the description.
  struct Place {
    std::size_t body = 0, link = 0;
    glm::dmat4 file_from_link{1.0};
  };

  ModelBody anchored(const Location& where) {
    ModelBody body{.model = {}, .is_held = true, .point = ""};
    body.model.links.push_back({.name = "", .inertial = {}, .collisions = {}, .where = where});
    return body;
  }

  void add_body(std::size_t index) {
    const MjcfBody& body = tree_.bodies[index];
    const Place parent = place_[body.parent];
    Place& own = place_[index];
    own = parent;
    own.file_from_link = parent.file_from_link * body.parent_from_body;
    const bool in_static = parent.body == 0;
    const bool is_free = !body.joints.empty() && body.joints.front().motion.kind == ModelJoint::Kind::floating;
    glm::dmat4 parent_from_body = body.parent_from_body;
    if (in_static && moves(body)) {
      own.body = is_free || held_ == 0 ? file_.bodies.size() : held_;
      own.link = 0;
      if (is_free) {
        ModelBody free{.model = {}, .file_from_root = own.file_from_link, .point = body.name};
        free.carrier = body.joints.front().motion.name;
        free.model.links.push_back(read_link(body));
        file_.bodies.push_back(std::move(free));
        return;
      }
      if (held_ == 0) file_.bodies.push_back(anchored(body.element.at()));
      held_ = own.body;
      parent_from_body = own.file_from_link;
    } else if (in_static) {
      // Bodies that nothing moves hang on the file's frame one by one.
      own.link = 0;
      parent_from_body = own.file_from_link;
    }
    add_joints(body, parent_from_body, own);
    if (!in_static) file_.contacts.apart.push_back({tree_.bodies[body.parent].name, body.name, true});
  }

  static bool moves(const MjcfBody& body) { return !body.joints.empty(); }

  // The joints of a body one after the other, then the body itself.
  void add_joints(const MjcfBody& body, glm::dmat4 parent_from_here, Place& own) {
    ModelTree& model = file_.bodies[own.body].model;
    for (const MjcfJoint& each : body.joints) {
      if (each.motion.kind == ModelJoint::Kind::floating) {
        report_.leave_out("free joint within a body that moves", each.element.at());
        continue;
      }
      glm::dmat4 there(1), back(1);
      there[3] = glm::dvec4(each.anchor, 1);
      back[3] = glm::dvec4(-each.anchor, 1);
      ModelJoint joint = each.motion.kind == ModelJoint::Kind::ball ? read_ball(each) : read_joint(each);
      joint.parent = own.link;
      joint.child = own.link = model.links.size();
      joint.parent_from_joint = parent_from_here * there;
      model.links.push_back({.name = each.motion.name + " (joint)",
                             .inertial = {},
                             .collisions = {},
                             .is_between_joints = true,
                             .where = body.element.at()});
      model.joints.push_back(std::move(joint));
      parent_from_here = back;
    }
    ModelJoint fixed;
    fixed.parent = own.link;
    fixed.child = model.links.size();
    fixed.parent_from_joint = parent_from_here;
    fixed.where = body.element.at();
    own.link = model.links.size();
    model.links.push_back(read_link(body));
    model.joints.push_back(std::move(fixed));
  }

  ModelJoint read_joint(const MjcfJoint& from) {
    const MjcfElement& element = from.element;
    const bool turns = from.motion.kind == ModelJoint::Kind::revolute;
    const double unit = turns && element.model().is_degrees ? glm::radians(1.0) : 1;
    const double ref = element.number("ref", 0) * unit;
    ModelJoint joint = from.motion;
    joint.damping = unless_off("damper", element, "damping");
    joint.damps_new_speed = true;  // as MuJoCo does; hands have joints that would explode otherwise
    joint.friction = unless_off("frictionloss", element, "frictionloss");
    joint.stiffness = unless_off("spring", element, "stiffness");
    joint.rest = element.number("springref", 0) * unit - ref;
    joint.rotor_inertia = not_negative(element, "armature");
    if (element.find("springdamper")) report_.leave_out("\"springdamper\" of a joint", element.at());
    read_drive(from, ref, joint);
    known_joints_.insert(from.own);
    return joint;
  }

  // Its spring turns it back to the pose of the file.
  ModelJoint read_ball(const MjcfJoint& from) {
    const MjcfElement& element = from.element;
    ModelJoint joint = from.motion;
    joint.damping = unless_off("damper", element, "damping");
    joint.damps_new_speed = true;
    joint.stiffness = unless_off("spring", element, "stiffness");
    for (const char* const name : {"range", "frictionloss", "armature", "springdamper"}) {
      const auto value = element.find(name);
      const bool is_set = value && value->find_first_of("123456789") != std::string::npos;
      if (is_set) report_.leave_out(in_quotes(name) + " of a ball joint", element.at());
    }
    return joint;
  }

  void read_drive(const MjcfJoint& from, double ref, ModelJoint& joint) {
    const auto found = drives_.find(from.own);
    if (found == drives_.end()) return;
    ModelDrive drive = found->second;
    if (drive.kind == ModelDrive::Kind::position) {
      drive.start -= ref;
      if (drive.lower) *drive.lower -= ref;
      if (drive.upper) *drive.upper -= ref;
    }
    if (const auto range = mjcf_limits(from.element, "actuatorfrcrange", "actuatorfrclimited")) {
      drive.min_effort = std::clamp(drive.min_effort, (*range)[0], (*range)[1]);
      drive.max_effort = std::clamp(drive.max_effort, (*range)[0], (*range)[1]);
    }
    joint.drive = drive;
  }

  // An attribute of a joint, which a flag of the options may switch off.
  double unless_off(std::string_view flag, const MjcfElement& element, const char* attribute) const {
    const double value = not_negative(element, attribute);
    return model_.is_off(flag) ? 0 : value;
  }

  static double not_negative(const MjcfElement& element, const char* attribute) {
    const double value = element.number(attribute, 0);
    if (value < 0) element.fail("has a " + std::string(attribute) + " below 0, expected at least 0");
    return value;
  }

  ModelLink read_link(const MjcfBody& body) {
    ModelLink link{.name = body.name, .inertial = {}, .collisions = {}, .where = body.element.at()};
    add_content(body, link);
    if (body.element.number("gravcomp", 0) != 0) report_.leave_out("\"gravcomp\" of a body", body.element.at());
    return link;
  }

  void add_content(const MjcfBody& body, ModelLink& link) {
    const bool is_static = body.parent == 0 && body.name.empty();
    if (!is_static) {
      link.inertial = read_mjcf_inertial(body);
      link.mass_bounds = read_mjcf_mass_bounds(body);
    }
    for (const MjcfGeom& geom : body.geoms) {
      if (!is_static && !link.inertial) shapes_.add_solid(geom, link);
      if (!model_.is_off("contact")) shapes_.add_collision(geom, link);
    }
  }

  void read_excludes() {
    std::map<std::string, const MjcfBody*> by_name;
    by_name.emplace("world", &tree_.bodies.front());
    for (const MjcfBody& body : tree_.bodies) {
      if (!body.own.empty()) by_name.emplace(body.own, &body);
    }
    for (const auto& [section, prefix] : tree_.sections("contact")) {
      const auto find = [&, &before = prefix](const std::string& name) {
        return by_name.find(name == "world" ? name : before + name);
      };
      for (const MjcfElement& each : section.children()) {
        if (each.tag() != "exclude") {
          report_.leave_out("<" + std::string(each.tag()) + "> of contacts", each.at());
          continue;
        }
        const auto a = find(each.text("body1")), b = find(each.text("body2"));
        if (a != by_name.end() && b != by_name.end()) {
          file_.contacts.apart.push_back({a->second->name, b->second->name});
        } else if (prefix.empty()) {  // of an attached model, some bodies may be left out
          report_.warn(each.at(), "<exclude> names a body that is not there; it is left out");
        }
      }
    }
  }

  // Air, wind and flags that change motion and are not taken over.
  void report_options() {
    for (const MjcfElement& option : model_.sections("option")) {
      for (const char* const name : {"density", "viscosity", "wind", "magnetic"}) {
        const auto written = option.written(name);
        if (written && written->find_first_of("123456789") != std::string::npos) {
          report_.leave_out("<option " + std::string(name) + ">", option.at());
        }
      }
      for (const MjcfElement& child : option.children()) {
        if (child.tag() != "flag") continue;
        for (const auto& [name, value] : {std::pair("filterparent", "disable"), std::pair("override", "enable"),
                                          std::pair("clampctrl", "disable")}) {
          if (child.written(name) == value)
            report_.leave_out("<flag " + std::string(name) + "> of <option>", child.at());
        }
      }
    }
  }

  const MjcfTree& tree_;
  const MjcfModel& model_;
  ImportReport report_, ignored_;  // the importer has told what stands in the latter
  MjcfAssets assets_;
  MjcfShapes shapes_;
  std::map<std::string, ModelDrive> drives_;
  std::vector<Place> place_;  // of each body
  std::size_t held_ = 0;  // the body of all that joints hold at the world, so that equalities may couple them; 0: none
  std::set<std::string> known_joints_;
  ModelDescription file_;
};

}  // namespace

ModelDescription MjcfSource::describe(ContentPool& pool) { return MjcfDescriber(*tree_, pool).run(); }

ModelWorld MjcfSource::world() {
  ModelWorld world{.gravity_m_s2 = kMjcfGravity_m_s2, .step_s = kMjcfStep_s, .iterations = {}};
  for (const MjcfElement& option : tree_->model().sections("option")) {
    world.gravity_m_s2 = option.vector("gravity", *world.gravity_m_s2);
    world.step_s = option.number("timestep", *world.step_s);
    if (!(*world.step_s >= kMinModelStep_s && *world.step_s <= kMaxModelStep_s)) {
      option.fail("has a timestep of " + format_number(*world.step_s) + " s, expected " +
                  format_number(kMinModelStep_s) + " to " + format_number(kMaxModelStep_s) + " s");
    }
  }
  if (tree_->model().is_off("gravity")) world.gravity_m_s2 = glm::dvec3(0);
  return world;
}

}  // namespace simvis
