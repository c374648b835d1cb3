#include "elements/visualization/frame_axes.h"

namespace simvis {
namespace {

constexpr AttributeSpec kFrameAxesAttributes[] = {
    marker_size_row("length", "0.5", "length of each arrow; 0: not drawn"),
    marker_size_row("width", "0.02", "thickness of the shafts; 0: not drawn"),
};

const ElementRegistration kFrameAxesRegistration({
    .name = "frame_axes",
    .summary = "Arrows along the axes of the frame at its insertion point: x red, y green, z blue.",
    .notes = "Only cameras with view=\"visualization\" show it; simulated sensors never see it.",
    .attributes = kFrameAxesAttributes,
    .create = [](const ElementContext& context) -> std::unique_ptr<Element> {
      return std::make_unique<FrameAxesElement>(context);
    },
});

// Linear RGBA. The colours are visible on light and dark backgrounds and are not too bright.
constexpr glm::vec4 kAxisColor[3] = {{0.8f, 0.02f, 0.02f, 1}, {0.02f, 0.5f, 0.02f, 1}, {0.03f, 0.1f, 0.9f, 1}};

}  // namespace

FrameAxesElement::FrameAxesElement(const ElementContext& context)
    : name_(context.command.require("name").value), nodes_(make_marker_nodes(name_)) {
  context.scene.insert(context.command, nodes_.separator);
}

void FrameAxesElement::update(ParameterView values) {
  MarkerMesh markers;
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 tip{0};
    tip[axis] = values[0];
    markers.add_arrow(glm::dvec3(0), tip, values[1], kAxisColor[axis]);
  }
  nodes_.shape->set_mesh(markers.take(name_));
}

}  // namespace simvis
