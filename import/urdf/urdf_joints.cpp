#include "import/urdf/urdf_joints.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "import/model/joint_commands.h"
#include "import/urdf/urdf_pose.h"

namespace simvis {
namespace {

ModelJoint::Kind kind_of(const UrdfFile& file, const urdf::Joint& joint) {
  switch (joint.type) {
    case urdf::Joint::REVOLUTE:
      return ModelJoint::Kind::revolute;
    case urdf::Joint::CONTINUOUS:
      return ModelJoint::Kind::continuous;
    case urdf::Joint::PRISMATIC:
      return ModelJoint::Kind::prismatic;
    case urdf::Joint::FLOATING:
      return ModelJoint::Kind::floating;
    case urdf::Joint::PLANAR:
      return ModelJoint::Kind::planar;
    case urdf::Joint::FIXED:
      return ModelJoint::Kind::fixed;
    default:
      file.fail("joint", joint.name, "has an unknown type");
  }
}

ModelJoint read_joint(const UrdfFile& file, const urdf::Joint& from) {
  ModelJoint joint{.kind = kind_of(file, from), .name = from.name, .leader = {}, .where = file.at("joint", from.name)};
  joint.parent_from_joint = matrix_of(from.parent_to_joint_origin_transform);
  const bool has_axis = joint.kind != ModelJoint::Kind::fixed && joint.kind != ModelJoint::Kind::floating;
  const glm::dvec3 axis(from.axis.x, from.axis.y, from.axis.z);
  const double largest = std::max({std::abs(axis.x), std::abs(axis.y), std::abs(axis.z)});
  if (has_axis && !(largest > 0)) {
    file.fail("joint", joint.name, "has the axis 0 0 0, expected a vector that is not zero");
  }
  if (has_axis) joint.axis = glm::normalize(axis / largest);
  const bool has_limits = joint.kind == ModelJoint::Kind::revolute || joint.kind == ModelJoint::Kind::prismatic;
  if (has_limits && from.limits && !file.mending.joints_without_limits.contains(joint.name)) {
    joint.lower = from.limits->lower;
    joint.upper = from.limits->upper;
  }
  if (!from.mimic) return joint;
  joint.leader = from.mimic->joint_name;
  joint.multiplier = from.mimic->multiplier;
  joint.offset = from.mimic->offset;
  return joint;
}

}  // namespace

std::map<std::string, ModelJoint> read_urdf_joints(const UrdfFile& file) {
  std::map<std::string, ModelJoint> joints;
  std::vector<ModelJoint*> all;
  for (const auto& [name, joint] : file.robot->joints_) {
    all.push_back(&joints.emplace(name, read_joint(file, *joint)).first->second);
  }
  resolve_leaders(all, [&](const ModelJoint& joint, const std::string& what) { file.fail("joint", joint.name, what); });
  return joints;
}

}  // namespace simvis
