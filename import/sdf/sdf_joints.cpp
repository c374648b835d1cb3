#include "import/sdf/sdf_joints.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "import/model/joint_commands.h"
#include "import/sdf/sdf_command.h"

namespace simvis {
namespace {

ModelJoint::Kind kind_of(const SdfElement& joint) {
  const std::string type = joint.attribute("type");
  if (type == "revolute" || type == "hinge") return ModelJoint::Kind::revolute;
  if (type == "continuous") return ModelJoint::Kind::continuous;
  return type == "prismatic" ? ModelJoint::Kind::prismatic : ModelJoint::Kind::fixed;
}

glm::dvec3 axis_of(const SdfLink& link, SdfPoses& poses) {
  const SdfElement axis = link.joint->element.child("axis");
  const glm::dvec3 xyz = axis.child("xyz").vector(glm::dvec3(0, 0, 1));
  const double largest = std::max({std::abs(xyz.x), std::abs(xyz.y), std::abs(xyz.z)});
  if (!(largest > 0)) axis.fail("is 0 0 0, expected a vector that is not zero");
  return glm::normalize(glm::dmat3(sdf_joint_from_axis(link, poses)) * (xyz / largest));
}

void read_limits(const SdfElement& axis, ModelJoint& joint, ImportReport& report) {
  const SdfElement limit = axis.child("limit");
  const double lower = limit.child("lower").number(-kSdfNoLimit), upper = limit.child("upper").number(kSdfNoLimit);
  if (lower > upper) {
    return report.warn(limit.at(), "the lower limit " + format_number(lower) + " is above the upper limit " +
                                       format_number(upper) + "; the joint has no limits");
  }
  if (lower > -kSdfNoLimit) joint.lower = lower;
  if (upper < kSdfNoLimit) joint.upper = upper;
}

SdfElement mimic_of(const SdfLink& link) { return link.joint->element.child("axis").child("mimic"); }

// The link that a joint of this name moves, as seen from a scope: "NAME", or "MODEL::NAME" for one within a model.
const SdfLink* find_moved_link(const SdfScope& scope, const std::string& name, const SdfTree& tree) {
  const std::size_t colons = name.find("::");
  if (colons != std::string::npos) {
    const auto model = scope.by_name.find(name.substr(0, colons));
    if (model == scope.by_name.end() || model->second->scope == nullptr) return nullptr;
    return find_moved_link(*model->second->scope, name.substr(colons + 2), tree);
  }
  for (const auto& link : tree.links) {
    if (link->joint != nullptr && link->joint_scope == &scope && link->joint->name == name) return link.get();
  }
  return nullptr;
}

// value = multiplier * (that of the leader - reference) + offset.
void read_mimic(const SdfLink& link, const SdfTree& tree, ModelJoint& joint, const WrongLeader& wrong) {
  const SdfElement mimic = mimic_of(link);
  if (!mimic) return;
  joint.multiplier = mimic.child("multiplier").number(1);
  joint.offset = mimic.child("offset").number(0) - joint.multiplier * mimic.child("reference").number(0);
  if (!std::isfinite(joint.multiplier) || !std::isfinite(joint.offset)) mimic.fail("has a number that is not finite");
  const std::string name = mimic.attribute("joint");
  const SdfLink* const leader = find_moved_link(*link.joint_scope, name, tree);
  if (leader == nullptr) return wrong(joint, "mimics joint " + in_quotes(name) + ", which is not there");
  joint.leader = leader->joint_name;
}

ModelJoint read_joint(const SdfLink& link, SdfPoses& poses, ImportReport& report) {
  const SdfElement& element = link.joint->element;
  ModelJoint joint{.kind = kind_of(element), .name = link.joint_name, .leader = {}, .where = element.at()};
  if (joint.kind == ModelJoint::Kind::fixed) {
    const std::string type = element.attribute("type");
    if (type != "fixed") report.leave_out("motion of a joint of type " + in_quotes(type), element.at());
    return joint;
  }
  joint.axis = axis_of(link, poses);
  if (joint.kind != ModelJoint::Kind::continuous) read_limits(element.child("axis"), joint, report);
  return joint;
}

}  // namespace

void read_sdf_joints(SdfTree& tree, SdfPoses& poses, ImportReport& report) {
  std::vector<ModelJoint*> joints;
  std::map<const ModelJoint*, const SdfLink*> link_of;
  for (const auto& link : tree.links) {
    if (link->joint == nullptr) continue;
    link->motion = read_joint(*link, poses, report);
    joints.push_back(&*link->motion);
    link_of[&*link->motion] = link.get();
  }
  const WrongLeader warn = [&](const ModelJoint& joint, const std::string& what) {
    const SdfLink& link = *link_of.at(&joint);
    report.warn(mimic_of(link).at(), "joint " + in_quotes(link.joint->name) + " " + what + "; it moves by itself");
  };
  for (ModelJoint* joint : joints) {
    if (joint->kind != ModelJoint::Kind::fixed) read_mimic(*link_of.at(joint), tree, *joint, warn);
  }
  resolve_leaders(joints, warn);
}

}  // namespace simvis
