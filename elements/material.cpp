#include "elements/material.h"

#include <algorithm>
#include "scenegraph/clone_graph.h"

namespace simvis {
namespace {

// Products of a few of these limits and a light's intensity are finite as float32.
constexpr double kMaxFactor = 1000, kMaxEmission = 1e12;
constexpr double kMaxGain = 1e9;  // far above the gain of corner cubes

constexpr AttributeSpec live(std::string_view name, std::string_view by_default, std::string_view text, double max) {
  return {.name = name, .default_value = by_default, .text = text, .min = 0, .max = max, .live = true};
}
constexpr AttributeSpec factor_color(std::string_view name) {
  return live(name, "1", "factor of the file's base colour, linear", kMaxFactor);
}
constexpr AttributeSpec emission(std::string_view name) {
  return live(name, "0", "linear radiance, added to the file's", kMaxEmission);
}

constexpr AttributeSpec kMaterialAttributes[] = {
    {.name = "part", .kind = AttributeKind::part, .text = "required: the part to change"},
    {.name = "material",
     .kind = AttributeKind::text,
     .text = "only materials of this name in the part's file; default: all materials"},
    factor_color("red"),
    factor_color("green"),
    factor_color("blue"),
    live("opacity", "1", "factor of the file's opacity; below 0.5 depth cameras and scanners see through; 0: not drawn",
         1),
    live("roughness", "1", "factor of the file's roughness, which is 1 by default; 1 is matte, 0 is polished", 1),
    emission("emission_red"),
    emission("emission_green"),
    emission("emission_blue"),
    {.name = "fixed_opacity",
     .text = "opacity in place of the file's, before the factor `opacity` applies; default: the file's",
     .min = 0,
     .max = 1},
    {.name = "reflectance",
     .text = "share of laser light that is reflected; default: the mean of the linear base colour",
     .min = 0,
     .max = 1},
    {.name = "retro_reflectance",
     .text = "gain of a retro-reflector for lasers, pi R_A; a white matte wall is 1; default: no retro-reflector",
     .min = 0,
     .max = kMaxGain},
    live("mirror", "0", "lasers: share of the remaining surface that becomes a mirror", 1),
    live("transmission", "0", "lasers: share of the remaining surface that becomes a thin pane of glass", 1),
    {.name = "refractive_index",
     .default_value = "1",
     .text = "factor of the file's refractive index, which is 1.5 by default",
     .min = 0.1,
     .max = 10,
     .live = true},
};

const ElementRegistration kMaterialRegistration({
    .name = "material",
    .summary = "Changes how one part looks and how it reflects laser light.",
    .notes = "Other parts from the same file keep their look. An attribute that is not given leaves the file's value. "
             "Roughness and emission have no effect on unlit materials.",
    .attributes = kMaterialAttributes,
    .create = [](const ElementContext& context) -> std::unique_ptr<Element> {
      return std::make_unique<MaterialElement>(context);
    },
});

void check_name(const AttributeValues& attributes, const std::vector<std::shared_ptr<MaterialNode>>& materials) {
  const std::string& part = attributes.text("part");
  if (materials.empty()) fail_at(attributes.where("part"), "part " + in_quotes(part) + " has no materials to change");
  if (!attributes.is_set("material")) return;
  const std::string& name = attributes.text("material");
  std::vector<std::string_view> known;
  std::string list;
  for (const auto& node : materials) {
    if (node->name == name) return;
    if (node->name.empty() || std::ranges::find(known, node->name) != known.end()) continue;
    known.push_back(node->name);
    list += (list.empty() ? "" : ", ") + node->name;
  }
  fail_at(attributes.where("material"),
          "there is no material " + in_quotes(name) + " in part " + in_quotes(part) + suggestion(name, known) +
              (list.empty() ? " (no material of its file has a name)" : " (expected one of: " + list + ")"));
}

}  // namespace

MaterialElement::MaterialElement(const ElementContext& context) {
  const AttributeValues& attributes = context.attributes;
  if (attributes.is_set("fixed_opacity")) fixed_opacity_ = static_cast<float>(attributes.number("fixed_opacity"));
  if (attributes.is_set("reflectance")) reflectance_ = static_cast<float>(attributes.number("reflectance"));
  if (attributes.is_set("retro_reflectance")) {
    retro_reflectance_ = static_cast<float>(attributes.number("retro_reflectance"));
  }
  const CommandAttribute& part = context.command.require("part");
  std::vector<std::shared_ptr<MaterialNode>> materials;
  for (const NodePtr& node : nodes_of(context.scene.own_part(part.value, part.where).root)) {
    if (node->kind() == NodeKind::material) materials.push_back(std::static_pointer_cast<MaterialNode>(node));
  }
  check_name(attributes, materials);
  // An empty node that marks the position of the element in the graph.
  context.scene.insert(context.command, std::make_shared<Separator>());
  for (const auto& node : materials) {
    if (attributes.is_set("material") && node->name != attributes.text("material")) continue;
    const std::size_t number = node->add_change();
    changed_.push_back({node, number});
    context.scene.undo().add([node, number] { node->remove_change(number); },
                             [node, number] { node->restore_change(number); });
  }
}

void MaterialElement::update(ParameterView values) {
  const MaterialChange change{.color = glm::vec3(values[0], values[1], values[2]),
                              .opacity = static_cast<float>(values[3]),
                              .roughness = static_cast<float>(values[4]),
                              .emission = glm::vec3(values[5], values[6], values[7]),
                              .mirror = static_cast<float>(values[8]),
                              .transmission = static_cast<float>(values[9]),
                              .refractive_index = static_cast<float>(values[10]),
                              .fixed_opacity = fixed_opacity_,
                              .reflectance = reflectance_,
                              .retro_reflectance = retro_reflectance_};
  for (const Changed& changed : changed_) changed.node->set_change(changed.number, change);
}

}  // namespace simvis
