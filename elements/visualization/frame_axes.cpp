#include "elements/visualization/frame_axes.h"

namespace simvis {
namespace {

const AttributeRows<FrameAxesLook> kFrameAxesRows{
    row(&FrameAxesLook::length_m, "length", "m", kMarkerSize_m, "length of each arrow; 0: not drawn").live(),
    row(&FrameAxesLook::width_m, "width", "m", kMarkerSize_m, "thickness of the shafts; 0: not drawn").live()};

const ElementRegistration kFrameAxesRegistration({
    .name = "frame_axes",
    .summary = "Arrows along the axes of the frame at its insertion point: x red, y green, z blue.",
    .notes = "Only cameras with view=\"visualization\" show it; simulated sensors never see it.",
    .attributes = kFrameAxesRows.table(),
    .create = create_element<FrameAxesElement>,
});

// Linear RGBA. The colours are visible on light and dark backgrounds and are not too bright.
constexpr glm::vec4 kAxisColor[3] = {{0.8f, 0.02f, 0.02f, 1}, {0.02f, 0.5f, 0.02f, 1}, {0.03f, 0.1f, 0.9f, 1}};

}  // namespace

FrameAxesElement::FrameAxesElement(const ElementContext& context)
    : name_(context.command.require("name").value), nodes_(make_marker_nodes(name_)) {
  context.scene.insert(context.command, nodes_.separator);
}

void FrameAxesElement::update(ParameterView values) {
  FrameAxesLook look;
  kFrameAxesRows.set(look, values);
  MarkerMesh markers;
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 tip{0};
    tip[axis] = look.length_m;
    markers.add_arrow(glm::dvec3(0), tip, look.width_m, kAxisColor[axis]);
  }
  nodes_.shape->set_mesh(markers.take(name_));
}

}  // namespace simvis
