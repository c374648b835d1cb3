#include "elements/visibility.h"

namespace simvis {
namespace {

constexpr AttributeSpec kVisibilityAttributes[] = {
    {.name = "visible", .default_value = "1", .text = "visible from 0.5 upwards", .min = 0, .max = 1, .live = true},
};

const ElementRegistration kVisibilityRegistration({
    .name = "visibility",
    .summary = "Shows or hides the shapes and lights that follow its insertion point.",
    .notes = "Sensors that follow keep measuring.",
    .attributes = kVisibilityAttributes,
    .create = create_element<VisibilityElement>,
});

}  // namespace

VisibilityElement::VisibilityElement(const ElementContext& context) : node_(std::make_shared<Visibility>()) {
  node_->name = context.command.require("name").value;
  context.scene.insert(context.command, node_);
}

void VisibilityElement::update(ParameterView values) { node_->set_visible(values[0] >= 0.5); }

}  // namespace simvis
