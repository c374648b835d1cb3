#include "elements/visibility.h"

namespace simvis {
namespace {

constexpr AttributeSpec kVisibilityAttributes[] = {
    {.name = "visible",
     .default_value = "1",
     .text = "1 is there, 0 is not; there from one half up",
     .min = 0,
     .max = 1,
     .live = true},
};

const ElementRegistration kVisibilityRegistration({
    .name = "visibility",
    .summary = "shows or hides what follows its insertion point",
    .attributes = kVisibilityAttributes,
    .create = [](const ElementContext& context) -> std::unique_ptr<Element> {
      return std::make_unique<VisibilityElement>(context);
    },
});

}  // namespace

VisibilityElement::VisibilityElement(const ElementContext& context) : node_(std::make_shared<Visibility>()) {
  node_->name = context.command.require("name").value;
  context.scene.insert(context.command, node_);
}

void VisibilityElement::update(ParameterView values) { node_->set_visible(values[0] >= 0.5); }

}  // namespace simvis
