#include "elements/joint.h"

#include <algorithm>
#include <cmath>

#include "scenegraph/pose.h"

namespace simvis {
namespace {

constexpr AttributeSpec kAttributes[] = {
    {.name = "axis",
     .kind = AttributeKind::vector,
     .default_value = "0 0 1",
     .text = "direction of the axis through the origin; its length does not matter"},
    {.name = "kind",
     .kind = AttributeKind::choice,
     .default_value = "revolute",
     .text = "turns about the axis, or slides along it",
     .choices = "revolute prismatic"},
    {.name = "lower",
     .kind = AttributeKind::number,
     .unit = "deg or m",
     .text = "lower limit of value; none if not given",
     .min = -kMaxCoordinate_m,
     .max = kMaxCoordinate_m},
    {.name = "upper",
     .kind = AttributeKind::number,
     .unit = "deg or m",
     .text = "upper limit of value; none if not given",
     .min = -kMaxCoordinate_m,
     .max = kMaxCoordinate_m},
    {.name = "value",
     .kind = AttributeKind::number,
     .default_value = "0",
     .unit = "deg or m",
     .text = "how far it is turned or slid",
     .min = -kMaxCoordinate_m,
     .max = kMaxCoordinate_m,
     .live = true},
};

const ElementRegistration kRegistration({
    .name = "joint",
    .summary = "turns what follows its insertion point about an axis, or slides it along one",
    .attributes = kAttributes,
    .create = [](const ElementContext& context) -> std::unique_ptr<Element> {
      return std::make_unique<JointElement>(context);
    },
});

glm::dvec3 read_axis(const AttributeValues& attributes) {
  const double(&v)[3] = attributes.vector("axis");
  const double largest = std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])});
  if (largest == 0) {
    fail_at(attributes.where("axis"), "attribute \"axis\": 0 0 0 is not allowed, expected a vector that is not zero");
  }
  // Divided by its largest part first, so that no square overflows or vanishes.
  return glm::normalize(glm::dvec3(v[0] / largest, v[1] / largest, v[2] / largest));
}

// Rodrigues' formula; the axis is of unit length.
glm::dmat4 turn_about(const glm::dvec3& axis, double angle_deg) {
  const auto [s, c] = sincos_deg(angle_deg);
  glm::dmat4 m{1.0};
  for (int column = 0; column < 3; ++column) {
    glm::dvec3 unit{0};
    unit[column] = 1;
    m[column] = glm::dvec4(c * unit + s * glm::cross(axis, unit) + (1 - c) * axis[column] * axis, 0);
  }
  return m;
}

}  // namespace

JointElement::JointElement(const ElementContext& context)
    : transform_(std::make_shared<Transform>()),
      axis_(read_axis(context.attributes)),
      revolute_(context.attributes.choice("kind") == "revolute"),
      lower_(-kMaxCoordinate_m),
      upper_(kMaxCoordinate_m) {
  const AttributeValues& attributes = context.attributes;
  if (attributes.is_set("lower")) lower_ = attributes.number("lower");
  if (attributes.is_set("upper")) upper_ = attributes.number("upper");
  if (lower_ > upper_) {
    fail_at(attributes.where("lower"), "attribute \"lower\": " + format_number(lower_) +
                                           " is not allowed, expected at most \"upper\", " + format_number(upper_));
  }
  transform_->name = context.command.require("name").value;
  context.scene.insert(context.command, transform_);
}

void JointElement::adapt_parameters(std::vector<AttributeSpec>& live_rows) const {
  AttributeSpec& value = live_rows[0];
  value.min = lower_;
  value.max = upper_;
  value.unit = revolute_ ? "deg" : "m";
}

void JointElement::update(ParameterView values) {
  if (revolute_) {
    transform_->set_matrix(turn_about(axis_, values[0]));
  } else {
    glm::dmat4 m{1.0};
    m[3] = {values[0] * axis_, 1};
    transform_->set_matrix(m);
  }
}

}  // namespace simvis
