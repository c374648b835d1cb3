#include "elements/pose.h"

#include <simvis/pose.h>

namespace simvis {
namespace {

constexpr AttributeSpec length(std::string_view name, std::string_view text) {
  return {.name = name,
          .kind = AttributeKind::number,
          .default_value = "0",
          .unit = "m",
          .text = text,
          .min = -kMaxCoordinate_m,
          .max = kMaxCoordinate_m,
          .live = true};
}

constexpr AttributeSpec angle(std::string_view name, std::string_view text) {
  return {.name = name,
          .kind = AttributeKind::number,
          .default_value = "0",
          .unit = "deg",
          .text = text,
          .live = true,
          .full_turn = true};
}

constexpr AttributeSpec kPoseAttributes[] = {
    length("x", "forward"),
    length("y", "to the left"),
    length("z", "up"),
    angle("roll", "turn about x, first"),
    angle("pitch", "turn about y, second; positive is nose down"),
    angle("yaw", "turn about z, last; positive is to the left"),
};

const ElementRegistration kPoseRegistration({
    .name = "pose",
    .summary = "Moves and turns what follows its insertion point.",
    .notes = "x is forward, y left, z up. The rotation is R = Rz(yaw) Ry(pitch) Rx(roll).",
    .attributes = kPoseAttributes,
    .create = [](const ElementContext& context) -> std::unique_ptr<Element> {
      return std::make_unique<PoseElement>(context);
    },
});

}  // namespace

PoseElement::PoseElement(const ElementContext& context) : transform_(std::make_shared<Transform>()) {
  transform_->name = context.command.require("name").value;
  context.scene.insert(context.command, transform_);
}

void PoseElement::update(ParameterView values) {
  transform_->set_matrix(matrix_from_degrees({values[0], values[1], values[2]}, values[3], values[4], values[5]));
}

}  // namespace simvis
