#include "import/urdf/urdf_joints.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <iterator>
#include <numbers>
#include <tuple>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/command.h>
#include <simvis/pose.h>
#include "engine/base/assert.h"

namespace simvis {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

struct Attribute {
  const char* name;
  std::string value;
};

std::string element(const char* type, const std::string& name, const std::string& link, std::vector<Attribute> rest) {
  Command command;
  command.kind = CommandKind::element;
  command.attributes = {{"type", type, {}}, {"name", name, {}}, {"insert_at", link, {}}};
  for (Attribute& attribute : rest) command.attributes.push_back({attribute.name, std::move(attribute.value), {}});
  return to_string(command);
}

std::string to_text(const glm::dvec3& v) {
  return format_number(v.x) + " " + format_number(v.y) + " " + format_number(v.z);
}

bool turns(const urdf::Joint& joint) {
  return joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::CONTINUOUS;
}
bool is_simple(const urdf::Joint& joint) { return turns(joint) || joint.type == urdf::Joint::PRISMATIC; }
double to_element_units(const urdf::Joint& joint) { return turns(joint) ? kDegrees : 1; }

class JointCommands {
 public:
  explicit JointCommands(const UrdfFile& file) : file_(file) {}

  std::vector<std::string> take() {
    std::vector<const urdf::Link*> open{file_.robot->getRoot().get()};
    while (!open.empty()) {
      const urdf::Link* link = open.back();
      open.pop_back();
      for (auto child = link->child_links.rbegin(); child != link->child_links.rend(); ++child) {
        open.push_back(child->get());
      }
      if (link->parent_joint) add(*link->parent_joint);
    }
    std::ranges::move(mimics_, std::back_inserter(commands_));
    return std::move(commands_);
  }

 private:
  [[noreturn]] void fail(const urdf::Joint& joint, const std::string& message) const {
    file_.fail("joint", joint.name, message);
  }

  void add(const urdf::Joint& joint) {
    if (joint.mimic) return add_mimic(joint);
    switch (joint.type) {
      case urdf::Joint::FIXED:
        return;
      case urdf::Joint::FLOATING:
        commands_.push_back(element("pose", joint.name, joint.child_link_name, {}));
        return;
      case urdf::Joint::PLANAR:
        return add_planar(joint);
      default:
        if (!is_simple(joint)) fail(joint, "has an unknown type");
        return add_simple(joint);
    }
  }

  glm::dvec3 axis_of(const urdf::Joint& joint) const {
    const glm::dvec3 axis(joint.axis.x, joint.axis.y, joint.axis.z);
    if (axis == glm::dvec3(0)) fail(joint, "has the axis 0 0 0, expected a vector that is not zero");
    return axis;
  }

  void add_simple(const urdf::Joint& joint) {
    std::vector<Attribute> rest{{"axis", to_text(axis_of(joint))}, {"kind", turns(joint) ? "revolute" : "prismatic"}};
    const bool is_open =
        joint.type == urdf::Joint::CONTINUOUS || file_.mending.joints_without_limits.contains(joint.name);
    if (joint.limits && !is_open) {
      const double unit = to_element_units(joint);
      const double lower = std::max(joint.limits->lower * unit, -kMaxCoordinate_m);
      const double upper = std::min(joint.limits->upper * unit, kMaxCoordinate_m);
      rest.push_back({"lower", format_number(lower)});
      rest.push_back({"upper", format_number(upper)});
      rest.push_back({"value", format_number(std::clamp(0.0, lower, upper))});
    }
    commands_.push_back(element("joint", joint.name, joint.child_link_name, std::move(rest)));
  }

  void add_planar(const urdf::Joint& joint) {
    glm::dvec3 axis = axis_of(joint);
    axis = glm::normalize(axis / std::max({std::abs(axis.x), std::abs(axis.y), std::abs(axis.z)}));
    constexpr double kNearX = 0.9;  // the cosine of 26 degrees
    const glm::dvec3 side = std::abs(axis.x) > kNearX ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
    const glm::dvec3 x = glm::normalize(side - glm::dot(side, axis) * axis), y = glm::cross(axis, x);
    for (const auto& [ending, direction, kind] :
         {std::tuple{"_X", x, "prismatic"}, {"_Y", y, "prismatic"}, {"_TURN", axis, "revolute"}}) {
      commands_.push_back(
          element("joint", joint.name + ending, joint.child_link_name, {{"axis", to_text(direction)}, {"kind", kind}}));
    }
  }

  // A mimic of a mimic follows the last joint of the chain.
  void add_mimic(const urdf::Joint& joint) {
    if (!is_simple(joint))
      fail(joint, "mimics another joint, expected mimic only in revolute, continuous and prismatic joints");
    double multiplier = joint.mimic->multiplier, offset = joint.mimic->offset;
    const urdf::Joint* leader = &follow(joint, joint);
    for (std::size_t steps = 0; leader->mimic; ++steps) {
      if (steps > file_.robot->joints_.size()) fail(joint, "mimics itself in a cycle");
      offset += multiplier * leader->mimic->offset;
      multiplier *= leader->mimic->multiplier;
      leader = &follow(joint, *leader);
    }
    const double unit = to_element_units(joint);
    mimics_.push_back(element("mimic_joint", joint.name, joint.child_link_name,
                              {{"leader", leader->name},
                               {"multiplier", format_number(multiplier * (unit / to_element_units(*leader)))},
                               {"offset", format_number(offset * unit)},
                               {"axis", to_text(axis_of(joint))},
                               {"kind", turns(joint) ? "revolute" : "prismatic"}}));
  }

  const urdf::Joint& follow(const urdf::Joint& asked, const urdf::Joint& joint) const {
    const std::string& name = joint.mimic->joint_name;
    const auto found = file_.robot->joints_.find(name);  // mend_urdf() removes a mimic of a joint that does not exist
    SIMVIS_ASSERT(found != file_.robot->joints_.end());
    if (!is_simple(*found->second)) {
      fail(asked, "mimics joint " + in_quotes(name) + ", expected one that is revolute, continuous or prismatic");
    }
    return *found->second;
  }

  const UrdfFile& file_;
  std::vector<std::string> commands_, mimics_;
};

}  // namespace

std::vector<std::string> urdf_joint_commands(const UrdfFile& file) { return JointCommands(file).take(); }

}  // namespace simvis
