#include "elements/label.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

namespace simvis {
namespace {

// Label images of 16 bits are common.
constexpr double kMaxClassId = 65535;

constexpr AttributeSpec kLabelRows[] = {
    {.name = "level",
     .kind = AttributeKind::choice,
     .text =
         "what is one object: the part or the model around what is named, as a whole; each link of it; each shape of a "
         "name in shapes, or each mesh; default: what is named, with shapes each shape of a name",
     .choices = "part model link shape"},
    {.name = "class", .kind = AttributeKind::text, .text = "required: name of the class"},
    {.name = "class_id",
     .kind = AttributeKind::integer,
     .text = "number of the class in images and scans; required once for each class",
     .min = 1,
     .max = kMaxClassId},
};

const ElementRegistration kLabelRegistration({
    .name = "label",
    .summary = "Makes objects of parts, links or shapes, with a class, for the outputs instance and semantic.",
    .notes = "Shapes without a class have the number 0, and are objects by their parts or links. A label with the "
             "nearest name of a shape takes precedence, then one "
             "with a material, over one of the whole part. What is inserted at a part later belongs to other parts and "
             "does not get its class.",
    .attributes = with_selection_rows(kLabelRows),
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

SelectionLevel level_of(const AttributeValues& attributes) {
  if (!attributes.is_set("level")) return attributes.is_set("shapes") ? SelectionLevel::shape : SelectionLevel::named;
  const std::string& level = attributes.choice("level");
  return level == "part"    ? SelectionLevel::part
         : level == "model" ? SelectionLevel::model
         : level == "link"  ? SelectionLevel::link
                            : SelectionLevel::shape;
}

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

// `"HAND"`, or `link "HAND" of part "ROBOT"`.
std::string described(const Scene& scene, const std::string& name) {
  const ObjectTree& tree = scene.objects();
  const std::optional<std::uint32_t> found = tree.find(name);
  if (!found || tree[*found].kind == ObjectKind::part) return in_quotes(name);
  return std::string(to_string(tree[*found].kind)) + " " + in_quotes(name) + " of part " +
         in_quotes(tree[tree[*found].part].name);
}

void check_unlabelled(const ElementContext& context, const Label& label, std::span<const Label* const> others) {
  for (const Label* const other : others) {
    const std::optional<SharedShapes> shared = shared_shapes(label.shapes, other->shapes);
    if (!shared) continue;
    fail_at(selection_place(context),
            described(context.scene, shared->point) + " already has the class " + in_quotes(other->class_name) +
                " from label " + in_quotes(other->element) + shared->which() +
                (label.shapes.points.at(shared->point) == other->shapes.points.at(shared->point)
                     ? ", expected one label for each part"
                     : ", expected labels either of a whole part or of what stands in it"));
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
              .shapes = selected_shapes(context, "label", level_of(attributes))};
  check_unlabelled(context, label, others);
  label.class_id = class_id_of(context, label, others);
  context.scene.insert_in_world(context.command, std::make_shared<LabelNode>(std::move(label)));
}

}  // namespace simvis
