#include "import/mjcf/mjcf_joints.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <simvis/attributes.h>

namespace simvis {
namespace {

ModelJoint::Kind joint_kind(const MjcfElement& joint) {
  static const std::map<std::string, ModelJoint::Kind> kinds = {{"free", ModelJoint::Kind::floating},
                                                                {"ball", ModelJoint::Kind::ball},
                                                                {"slide", ModelJoint::Kind::prismatic},
                                                                {"hinge", ModelJoint::Kind::revolute}};
  const std::string type = joint.tag() == "freejoint" ? "free" : joint.text("type", "hinge");
  const auto kind = kinds.find(type);
  if (kind == kinds.end()) joint.fail("has the type " + in_quotes(type) + ", expected free, ball, slide or hinge");
  return kind->second;
}

void read_limits(const MjcfElement& joint, ModelJoint& motion, ImportReport& report) {
  const MjcfModel& model = joint.model();
  const double unit = motion.kind == ModelJoint::Kind::revolute && model.is_degrees ? glm::radians(1.0) : 1;
  const double ref = joint.number("ref", 0);
  if (ref != 0) report.warn(joint.at(), "the joint has a \"ref\", which is its value 0 here");
  const std::vector<double> range = joint.numbers("range", 2, 2);
  const std::string limited = joint.text("limited", "auto");
  if (range.empty() || limited == "false" || (limited == "auto" && !model.autolimits)) return;
  if (range[0] > range[1]) {
    return report.warn(joint.at(), "the lower limit " + format_number(range[0]) + " is above the upper limit " +
                                       format_number(range[1]) + "; the joint has no limits");
  }
  motion.lower = (range[0] - ref) * unit;
  motion.upper = (range[1] - ref) * unit;
}

}  // namespace

MjcfJoint read_mjcf_joint(const MjcfElement& element, const glm::dmat4& body_from_frame, ImportReport& report) {
  MjcfJoint joint{.element = element, .own = "", .motion = {.kind = joint_kind(element), .name = ""}};
  joint.motion.where = element.at();
  if (joint.motion.kind == ModelJoint::Kind::floating) return joint;
  joint.anchor = glm::dvec3(body_from_frame * glm::dvec4(element.vector("pos", glm::dvec3(0)), 1));
  if (joint.motion.kind == ModelJoint::Kind::ball) return joint;
  const glm::dvec3 axis = element.vector("axis", glm::dvec3(0, 0, 1));
  const double largest = std::max({std::abs(axis.x), std::abs(axis.y), std::abs(axis.z)});
  if (!(largest > 0)) element.fail("has the axis 0 0 0, expected a vector that is not zero");
  joint.motion.axis = glm::normalize(glm::dmat3(body_from_frame) * (axis / largest));
  read_limits(element, joint.motion, report);
  return joint;
}

}  // namespace simvis
