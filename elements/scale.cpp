// The element `scale`: makes everything after its insertion point larger or smaller.
//
//   <element type="scale" name="GROW" insert_at="PLANT" x="2" y="2" z="2"/>
//
// Parameters  x y z (live): factors along the axes of the insertion point's frame. They are above 0: with a negative
//          factor a sensor after the element would have a left-handed frame, and with a factor of 0 it would have no
//          frame.
#include <simvis/element.h>
#include <simvis/node.h>

namespace simvis {
namespace {

class ScaleElement : public Element {
 public:
  explicit ScaleElement(const ElementContext& context);
  void update(ParameterView values) override;

 private:
  std::shared_ptr<Transform> transform_;
};

constexpr AttributeSpec factor(std::string_view name, std::string_view text) {
  return {.name = name, .default_value = "1", .text = text, .min = 1e-6, .max = 1e6, .live = true};
}

constexpr AttributeSpec kScaleAttributes[] = {
    factor("x", "factor of lengths along x"),
    factor("y", "factor of lengths along y"),
    factor("z", "factor of lengths along z"),
};

const ElementRegistration kScaleRegistration({
    .name = "scale",
    .summary = "Makes what follows its insertion point larger or smaller.",
    .attributes = kScaleAttributes,
    .create = create_element<ScaleElement>,
});

}  // namespace

ScaleElement::ScaleElement(const ElementContext& context) : transform_(std::make_shared<Transform>()) {
  transform_->name = context.command.require("name").value;
  context.scene.insert(context.command, transform_);
}

void ScaleElement::update(ParameterView values) {
  glm::dmat4 matrix{1.0};
  for (int axis = 0; axis < 3; ++axis) matrix[axis][axis] = values[static_cast<std::size_t>(axis)];
  transform_->set_matrix(matrix);
}

}  // namespace simvis
