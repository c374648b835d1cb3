#include "elements/pose.h"

#include "elements/pose_rows.h"

namespace simvis {
namespace {

const ElementRegistration kPoseRegistration({
    .name = "pose",
    .summary = "Moves and turns what follows its insertion point.",
    .notes = "x is forward, y left, z up. The rotation is R = Rz(yaw) Ry(pitch) Rx(roll).",
    .attributes = kPoseRows,
    .create = [](const ElementContext& context) -> std::unique_ptr<Element> {
      return std::make_unique<PoseElement>(context);
    },
});

}  // namespace

PoseElement::PoseElement(const ElementContext& context) : transform_(std::make_shared<Transform>()) {
  transform_->name = context.command.require("name").value;
  context.scene.insert(context.command, transform_);
}

void PoseElement::update(ParameterView values) { transform_->set_matrix(matrix_of_pose(values)); }

}  // namespace simvis
