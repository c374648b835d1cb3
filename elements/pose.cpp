#include "elements/pose.h"

#include <algorithm>

#include "elements/pose_rows.h"

namespace simvis {
namespace {

const ElementRegistration kPoseRegistration({
    .name = "pose",
    .summary = "Moves and turns what follows its insertion point.",
    .notes = "x is forward, y left, z up. The rotation is R = Rz(yaw) Ry(pitch) Rx(roll).",
    .attributes = kPoseRows,
    .create = create_element<PoseElement>,
});

}  // namespace

PoseElement::PoseElement(const ElementContext& context) : transform_(std::make_shared<Transform>()) {
  transform_->name = context.command.require("name").value;
  context.scene.insert(context.command, transform_);
}

void PoseElement::update(ParameterView values) {
  driver_->current = matrix_of_pose(values);
  driver_->was_set = driver_->was_set || !std::ranges::equal(values, shown_);
  transform_->set_matrix(driver_->current);
}

void PoseElement::advance(std::int64_t time_ns, std::span<double> values) {
  if (!driver_->value) return;
  const glm::dmat4 matrix = driver_->value(time_ns);
  if (driver_->was_set) return;
  write_pose(matrix, values);
  shown_.assign(values.begin(), values.end());
}

}  // namespace simvis
