// The targets of a robot's joints as parameters.
#include <algorithm>

#include "elements/dynamics/robot.h"
#include "engine/base/assert.h"

namespace simvis {

bool RobotElement::is_effort(const Joint& joint) {
  return joint.control == JointControl::effort ||
         (joint.control == JointControl::file && joint.described.model.drive->kind == ModelDrive::Kind::effort);
}

// A drive by position holds the joint where it stands; an actuator of a file starts as in its own program.
double RobotElement::target_at_start(const Joint& joint) {
  if (joint.control == JointControl::position || joint.control == JointControl::servo) return joint.start;
  if (joint.control != JointControl::file) return 0;
  return joint.described.model.drive->start;
}

AttributeSpec RobotElement::row_of_file(const Joint& joint, AttributeSpec row) {
  const ModelDrive& drive = *joint.described.model.drive;
  const bool turns = joint.to_si != 1;
  double unit = joint.to_si;
  switch (drive.kind) {
    case ModelDrive::Kind::position:
      row.unit = turns ? "deg" : "m";
      break;
    case ModelDrive::Kind::velocity:
      row.unit = turns ? "deg/s" : "m/s";
      break;
    case ModelDrive::Kind::effort:
      row.unit = turns ? "N m" : "N";
      unit = 1;
      break;
  }
  row.min = drive.lower.value_or(-kMaxCoordinate_m * unit) / unit;
  row.max = drive.upper.value_or(kMaxCoordinate_m * unit) / unit;
  if (drive.kind != ModelDrive::Kind::effort) row.rounding = JointElement::limit_rounding(turns);
  return row;
}

AttributeSpec RobotElement::row_of(const Joint& joint) const {
  const bool turns = joint.to_si != 1;
  AttributeSpec row{.name = joint.row, .default_value = joint.row_default, .text = joint.row_text, .live = true};
  double limit = 0;
  switch (joint.control) {
    case JointControl::position:
    case JointControl::servo:
      row.unit = turns ? "deg" : "m";
      row.min = joint.described.model.lower.value_or(-kMaxCoordinate_m * joint.to_si) / joint.to_si;
      row.max = joint.described.model.upper.value_or(kMaxCoordinate_m * joint.to_si) / joint.to_si;
      row.rounding = JointElement::limit_rounding(turns);
      return row;
    case JointControl::speed:
      row.unit = turns ? "deg/s" : "m/s";
      limit = joint.max_speed / joint.to_si;
      break;
    case JointControl::effort:
      row.unit = turns ? "N m" : "N";
      limit = joint.max_effort;
      break;
    case JointControl::file:
      return row_of_file(joint, row);
    case JointControl::none:
      break;
  }
  row.min = -limit;
  row.max = limit;
  return row;
}

AttributeSpec RobotElement::effort_row_of(const Joint& joint) {
  return {.name = joint.effort_row,
          .default_value = "0",
          .unit = joint.to_si != 1 ? "N m" : "N",
          .text = joint.effort_text,
          .min = -joint.max_effort,
          .max = joint.max_effort,
          .live = true};
}

void RobotElement::adapt_parameters(std::vector<AttributeSpec>& live_rows) const {
  for (const Joint& joint : joints_) {
    if (!joint.driver || joint.control == JointControl::none) continue;
    live_rows.push_back(row_of(joint));
    if (joint.control == JointControl::servo) live_rows.push_back(effort_row_of(joint));
  }
}

std::vector<RobotElement::DrivenJoint> RobotElement::driven_joints() const {
  using Kind = DrivenJoint::Kind;
  std::vector<DrivenJoint> driven;
  for (const Joint& joint : joints_) {
    if (!joint.driver || joint.control == JointControl::none) continue;
    const bool is_speed =
        joint.control == JointControl::speed ||
        (joint.control == JointControl::file && joint.described.model.drive->kind == ModelDrive::Kind::velocity);
    const Kind kind = is_effort(joint) ? Kind::effort : is_speed ? Kind::velocity : Kind::position;
    const AttributeSpec row = row_of(joint);
    driven.push_back({.name = joint.described.model.name,
                      .parameter = joint.row,
                      .effort_parameter = joint.control == JointControl::servo ? joint.effort_row : "",
                      .kind = kind,
                      .unit = kind == Kind::effort ? 1 : joint.to_si,
                      .min = row.min,
                      .max = row.max,
                      .rounding = row.rounding});
  }
  return driven;
}

bool RobotElement::follows(const std::string& joint) const {
  return std::ranges::any_of(joints_, [&](const Joint& each) {
    return each.described.leader.has_value() && each.described.model.name == joint;
  });
}

double RobotElement::joint_position(const std::string& joint) const {
  const auto found =
      std::ranges::find_if(joints_, [&](const Joint& each) { return each.described.model.name == joint; });
  SIMVIS_ASSERT(found != joints_.end() && found->driver);
  return found->driver->current * found->to_si;
}

}  // namespace simvis
