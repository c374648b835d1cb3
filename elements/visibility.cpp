// The element `visibility`: shows or hides everything after its insertion point.
//
//   <element type="visibility" name="SHOW" insert_at="DOOR" visible="0"/>
//
// Parameters  visible (live): shapes and lights are shown from 0.5 up, so that a trajectory may go from 0 to 1 between
//          two rows. If an outer visibility element hides them, an inner one cannot show them. Sensors after the
//          element keep measuring.
#include <simvis/element.h>
#include <simvis/node.h>

namespace simvis {
namespace {

class VisibilityElement : public Element {
 public:
  explicit VisibilityElement(const ElementContext& context);
  void update(ParameterView values) override;

 private:
  std::shared_ptr<Visibility> node_;
};

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
