#include "elements/label.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <utility>

#include <fnmatch.h>

#include "scenegraph/clone_graph.h"

namespace simvis {
namespace {

constexpr std::string_view kWorld = "ROOT";

// Label images of 16 bits are common.
constexpr double kMaxClassId = 65535;

constexpr AttributeSpec kLabelAttributes[] = {
    {.name = "part",
     .kind = AttributeKind::part,
     .text = "the part whose shapes have the class; default, without parts: those of insert_at alone"},
    {.name = "parts",
     .kind = AttributeKind::text,
     .text = "pattern of insertion points whose shapes have the class: * any text, ? any character"},
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
    .notes = "Shapes without a class have the number 0. A label with a material takes precedence over one of the same "
             "part without. What is inserted at a part later belongs to other parts and does not get its class.",
    .attributes = kLabelAttributes,
    .create = [](const ElementContext& context) -> std::unique_ptr<Element> {
      return std::make_unique<LabelElement>(context);
    },
});

// Holds a label in the scene graph, so that it leaves the scene with its element.
class LabelNode : public Separator {
 public:
  explicit LabelNode(Label label) : label_(std::move(label)) {}
  const Label& label() const { return label_; }

 private:
  Label label_;
};

bool matches(const std::string& pattern, const std::string& name) {
  return ::fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
}

std::set<std::string, std::less<>> labelled_points(const ElementContext& context) {
  const AttributeValues& attributes = context.attributes;
  if (attributes.is_set("part") && attributes.is_set("parts")) {
    fail_at(context.command.where, "attributes \"part\" and \"parts\": expected one of them, not both");
  }
  const Scene& scene = context.scene;
  if (!attributes.is_set("part") && !attributes.is_set("parts")) {
    const CommandAttribute& point = context.command.require("insert_at");
    if (point.value == kWorld) {
      fail_at(context.command.where,
              "a label needs the attribute \"part\" or \"parts\", expected one of them, or a part as insert_at");
    }
    if (scene.has_insertion_point(point.value)) return {point.value};
    fail_at(point.where, "there is no insertion point " + in_quotes(point.value) +
                             suggestion(point.value, scene.insertion_points()));
  }
  if (attributes.is_set("part")) {
    const std::vector<std::string> points = scene.points_of_part(attributes.text("part"));
    return {points.begin(), points.end()};
  }
  const std::string& pattern = attributes.text("parts");
  std::set<std::string, std::less<>> points;
  for (const std::string_view point : scene.insertion_points()) {
    const std::string name(point);
    if (point != kWorld && matches(pattern, name)) points.insert(name);
  }
  if (points.empty()) {
    fail_at(attributes.where("parts"), "no part or link matches " + in_quotes(pattern) +
                                           ", expected a pattern of names that were inserted before");
  }
  return points;
}

// The materials of the points' files and shapes that the attribute names, or matches as a pattern. Throws if there are
// none.
std::set<std::string, std::less<>> labelled_materials(const ElementContext& context, const Label& label) {
  if (!context.attributes.is_set("material")) return {};
  const std::string& wanted = context.attributes.text("material");
  std::set<std::string, std::less<>> known;
  for (const std::string_view part : context.scene.part_names()) {
    const std::vector<std::string> points = context.scene.points_of_part(part);
    const bool is_labelled =
        std::ranges::any_of(points, [&](const std::string& point) { return label.points.contains(point); });
    if (!is_labelled) continue;
    for (const NodePtr& node : nodes_of(context.scene.load_part(context.scene.part_command(part)).root)) {
      if (node->kind() == NodeKind::material && !node->name.empty()) known.insert(node->name);
    }
  }
  if (known.contains(wanted)) return {wanted};
  std::set<std::string, std::less<>> matching;
  std::ranges::copy_if(known, std::inserter(matching, matching.end()),
                       [&](const std::string& name) { return matches(wanted, name); });
  if (!matching.empty()) return matching;
  const std::vector<std::string_view> names(known.begin(), known.end());
  std::string list;
  for (const std::string& name : known) list += (list.empty() ? "" : ", ") + name;
  fail_at(context.attributes.where("material"),
          "there is no material " + in_quotes(wanted) + " in what the label names" + suggestion(wanted, names) +
              (list.empty() ? " (none of its materials has a name)" : " (expected one of: " + list + ")"));
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

void check_unlabelled(const ElementContext& context, const Label& label, std::span<const Label* const> others) {
  const AttributeValues& attributes = context.attributes;
  const Location where = attributes.is_set("part")    ? attributes.where("part")
                         : attributes.is_set("parts") ? attributes.where("parts")
                                                      : context.command.where;
  for (const Label* const other : others) {
    const auto material =
        std::ranges::find_if(label.materials, [&](const std::string& name) { return other->materials.contains(name); });
    const bool of_all = label.materials.empty() && other->materials.empty();
    if (!of_all && material == label.materials.end()) continue;
    for (const std::string& point : label.points) {
      if (!other->points.contains(point)) continue;
      fail_at(where, in_quotes(point) + " already has the class " + in_quotes(other->class_name) + " from label " +
                         in_quotes(other->element) + (of_all ? "" : " for the material " + in_quotes(*material)) +
                         ", expected one label for each part");
    }
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
              .points = labelled_points(context),
              .materials = {}};
  label.materials = labelled_materials(context, label);
  check_unlabelled(context, label, others);
  label.class_id = class_id_of(context, label, others);
  context.scene.insert_in_world(context.command, std::make_shared<LabelNode>(std::move(label)));
}

}  // namespace simvis
