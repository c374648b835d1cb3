#include <algorithm>
#include <cmath>
#include <string_view>

#include <simvis/pose.h>
#include "import/sdf/sdf_command.h"
#include "import/sdf/sdf_mimic.h"

namespace simvis {
namespace {

void add_sdf_limits(const SdfElement& axis, bool turns, SdfCommand& command, ImportReport& report) {
  const SdfElement limit = axis.child("limit");
  const double lower = limit.child("lower").number(-kSdfNoLimit), upper = limit.child("upper").number(kSdfNoLimit);
  if (lower > upper) {
    return report.warn(limit.at(), "the lower limit " + format_number(lower) + " is above the upper limit " +
                                       format_number(upper) + "; the joint has no limits");
  }
  const double unit = turns ? kSdfDegrees : 1;
  if (lower > -kSdfNoLimit) command.add("lower", std::max(lower * unit, -kMaxCoordinate_m));
  if (upper < kSdfNoLimit) command.add("upper", std::min(upper * unit, kMaxCoordinate_m));
  const double value = std::clamp(0.0, lower, upper) * unit;
  if (value != 0) command.add("value", std::clamp(value, -kMaxCoordinate_m, kMaxCoordinate_m));
}

}  // namespace

std::string sdf_axis_frame(const SdfElement& joint) {
  const SdfElement axis = joint.child("axis"), xyz = axis.child("xyz");
  constexpr int kFirstWithJointAxes = 5;  // before, axes stand in the model's frame
  const bool in_model = joint.file().version < kFirstWithJointAxes || axis.child("use_parent_model_frame").flag(false);
  if (in_model) return "__model__";
  return xyz ? xyz.attribute("expressed_in") : std::string();
}

std::optional<std::string> sdf_joint_command(const SdfElement& joint, const SdfPlace& place,
                                             const glm::dmat4& joint_from_axis, const std::optional<SdfMimic>& mimic,
                                             ImportReport& report) {
  const std::string type = joint.attribute("type");
  const bool turns = sdf_joint_turns(joint);
  if (type == "fixed") return std::nullopt;
  if (!turns && !sdf_joint_slides(joint)) {
    report.leave_out("motion of a joint of type " + in_quotes(type), joint.at());
    return std::nullopt;
  }
  const SdfElement axis = joint.child("axis");
  const glm::dvec3 xyz = axis.child("xyz").vector(glm::dvec3(0, 0, 1));
  if (xyz == glm::dvec3(0)) axis.fail("is 0 0 0, expected a vector that is not zero");
  const double largest = std::max({std::abs(xyz.x), std::abs(xyz.y), std::abs(xyz.z)});
  SdfCommand command(CommandKind::element, mimic ? "mimic_joint" : "joint", place);
  command.add("axis", glm::dvec3(joint_from_axis * glm::dvec4(xyz / largest, 0)));
  command.add("kind", turns ? "revolute" : "prismatic");
  if (mimic) {
    const double unit = turns ? kSdfDegrees : 1;
    command.add("leader", mimic->leader);
    command.add("multiplier", mimic->multiplier * unit / (mimic->leader_turns ? kSdfDegrees : 1));
    command.add("offset", mimic->offset * unit);
  } else if (type != "continuous") {
    add_sdf_limits(axis, turns, command, report);
  }
  return command.text();
}

}  // namespace simvis
