#include "elements/joint.h"

#include <algorithm>
#include <utility>

#include <simvis/pose.h>

namespace simvis {
namespace {

constexpr AttributeSpec kJointValueRows[] = {
    {.name = "lower",
     .kind = AttributeKind::number,
     .unit = "deg or m",
     .text = "lower limit of value; default: no limit",
     .min = -kMaxCoordinate_m,
     .max = kMaxCoordinate_m},
    {.name = "upper",
     .kind = AttributeKind::number,
     .unit = "deg or m",
     .text = "upper limit of value; default: no limit",
     .min = -kMaxCoordinate_m,
     .max = kMaxCoordinate_m},
    {.name = "value",
     .kind = AttributeKind::number,
     .default_value = "0",
     .unit = "deg or m",
     .text = "angle or length by which the joint is moved",
     .min = -kMaxCoordinate_m,
     .max = kMaxCoordinate_m,
     .live = true},
};

// Half of the last digit of a limit that is written with three decimals in degrees or six in metres. Limits of robots
// are often known only so: 3.14159 radians are 179.99985 degrees, and people write 180.
constexpr double kLimitRounding_deg = 0.5e-3, kLimitRounding_m = 0.5e-6;

const ElementRegistration kJointRegistration({
    .name = "joint",
    .summary = "Turns what follows its insertion point about an axis, or slides it along one.",
    .notes = "The axis passes through the origin of the insertion point. A revolute joint has its value and limits in "
             "degrees, a prismatic one in metres. A value beyond a limit by at most 0.0005 degrees or 0.0000005 m, the "
             "rounding of a limit, counts as the limit.",
    .attributes = AttributeRows<JointMotion>{rows_of<JointMotion>(), AttributeTable(kJointValueRows)}.table(),
    .create = create_element<JointElement>,
});

}  // namespace

JointElement::JointElement(const ElementContext& context)
    : transform_(std::make_shared<Transform>()),
      point_(context.command.require("insert_at").value),
      motion_(rows_of<JointMotion>().read(context.attributes)),
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
  value.rounding = limit_rounding(motion_.revolute);
  value.unit = motion_.revolute ? "deg" : "m";
  value.full_turn = motion_.revolute && !has_limits();
}

bool JointElement::has_limits() const { return lower_ != -kMaxCoordinate_m || upper_ != kMaxCoordinate_m; }

void JointElement::update(ParameterView values) {
  value_ = values[0];
  if (value_ != shown_) driver_->was_set = true;
  driver_->current = value_;
  transform_->set_matrix(motion_.at(value_));
  for (const auto& [number, follower] : followers_) follower(value_);
}

void JointElement::advance(std::int64_t time_ns, std::span<double> values) {
  const double position = driver_->value(time_ns);
  if (driver_->was_set) return;
  shown_ = std::clamp(position, lower_, upper_);
  values[0] = *shown_;
}

double JointElement::limit_rounding(bool revolute) { return revolute ? kLimitRounding_deg : kLimitRounding_m; }

std::size_t JointElement::follow(std::function<void(double)> follower) {
  follower(value_);
  followers_.emplace(next_follower_, std::move(follower));
  return next_follower_++;
}

}  // namespace simvis
