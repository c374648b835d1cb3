#include "elements/label.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

namespace simvis {
namespace {

// Label images of 16 bits are common.
constexpr double kMaxClassId = 65535;

constexpr AttributeSpec kLabelAttributes[] = {
    {.name = "part",
     .kind = AttributeKind::part,
     .text = "the part whose shapes have the class; default, without parts: those of insert_at alone"},
    {.name = "parts",
     .kind = AttributeKind::text,
     .text = "pattern of insertion points whose shapes have the class: * any text, ? any character"},
    {.name = "shapes",
     .kind = AttributeKind::text,
     .text = "only shapes of this name in their file, or that matches it as a pattern; default: all shapes"},
    {.name = "material",
     .kind = AttributeKind::text,
     .text = "only shapes with a material of this name, or that matches it as a pattern; default: all shapes"},
    {.name = "class", .kind = AttributeKind::text, .text = "required: name of the class"},
    {.name = "class_id",
     .kind = AttributeKind::integer,
     .text = "number of the class in images and scans; required once for each class",
     .min = 1,
     .max = kMaxClassId},
};

const ElementRegistration kLabelRegistration({
    .name = "label",
    .summary = "Gives the shapes of parts a class, for the outputs semantic of cameras and scanners.",
    .notes =
        "Shapes without a class have the number 0. A label with the nearest name of a shape takes precedence, then one "
        "with a material, over one of the whole part. What is inserted at a part later belongs to other parts and "
        "does not get its class.",
    .attributes = kLabelAttributes,
    .create = create_element<LabelElement>,
});

// Holds a label in the scene graph, so that it leaves the scene with its element.
class LabelNode : public Separator {
 public:
  explicit LabelNode(Label label) : label_(std::move(label)) {}
  const Label& label() const { return label_; }

 private:
  Label label_;
};

std::uint32_t class_id_of(const ElementContext& context, const Label& label, std::span<const Label* const> others) {
  const AttributeValues& attributes = context.attributes;
  const auto of_class = std::ranges::find(others, label.class_name, &Label::class_name);
  if (!attributes.is_set("class_id")) {
    if (of_class != others.end()) return (*of_class)->class_id;
    std::vector<std::string_view> known;
    for (const Label* const other : others) known.push_back(other->class_name);
    fail_at(attributes.where("class"), "class " + in_quotes(label.class_name) + " is unknown" +
                                           suggestion(label.class_name, known) +
                                           " (expected a class of a label before, or the attribute \"class_id\")");
  }
  const auto id = static_cast<std::uint32_t>(attributes.integer("class_id"));
  if (of_class != others.end() && (*of_class)->class_id != id) {
    fail_at(attributes.where("class_id"), "class " + in_quotes(label.class_name) + " has the id " +
                                              std::to_string((*of_class)->class_id) + " from label " +
                                              in_quotes((*of_class)->element) + ", expected no other");
  }
  const auto of_id = std::ranges::find(others, id, &Label::class_id);
  if (of_id != others.end() && (*of_id)->class_name != label.class_name) {
    fail_at(attributes.where("class_id"), "the id " + std::to_string(id) + " belongs to the class " +
                                              in_quotes((*of_id)->class_name) + " of label " +
                                              in_quotes((*of_id)->element) + ", expected another id");
  }
  return id;
}

void check_unlabelled(const ElementContext& context, const Label& label, std::span<const Label* const> others) {
  for (const Label* const other : others) {
    const std::optional<SharedShapes> shared = shared_shapes(label.shapes, other->shapes);
    if (!shared) continue;
    fail_at(selection_place(context), in_quotes(shared->point) + " already has the class " +
                                          in_quotes(other->class_name) + " from label " + in_quotes(other->element) +
                                          shared->which() + ", expected one label for each part");
  }
}

}  // namespace

std::vector<const Label*> labels_of(const Scene& scene) {
  std::vector<const Label*> labels;
  for (const NodePtr& child : scene.root()->children()) {
    if (const auto* const node = dynamic_cast<const LabelNode*>(child.get())) labels.push_back(&node->label());
  }
  return labels;
}

LabelElement::LabelElement(const ElementContext& context) {
  const AttributeValues& attributes = context.attributes;
  context.command.require("class");
  const std::vector<const Label*> others = labels_of(context.scene);
  Label label{.element = context.command.require("name").value,
              .class_name = attributes.text("class"),
              .shapes = selected_shapes(context, "label")};
  check_unlabelled(context, label, others);
  label.class_id = class_id_of(context, label, others);
  context.scene.insert_in_world(context.command, std::make_shared<LabelNode>(std::move(label)));
}

}  // namespace simvis
