// The element `material`: changes the look of one part; other parts from the same file do not change.
//
//   <element type="material" name="PAINT" insert_at="ROOT" part="TABLE" material="Wood" red="0.5" roughness="0.2"/>
//
// Parameters  are live and relative to the file, so that an attribute that is not given changes nothing. red green
//          blue, opacity and roughness are factors. emission_red, emission_green and emission_blue are added (W/(sr
//          m^2) or cd/m^2, the unit of the scene's lights). The colour multiplies the texture, as glTF's base colour
//          factor does. If the opacity is below 1 the surface is blended. If it is below one half, depth cameras and
//          scanners see through the surface.
// Opacity  `fixed_opacity` is not live. It replaces the file's opacity, and what else the file says about transparency
//          except the cut-outs of masks, before the factors apply.
// Lasers   `reflectance` and `retro_reflectance` are not live. They are absolute values for lasers, not factors,
//          because a colour says little about the near infrared. If several elements set them on one material, the last
//          one applies. `mirror` and `transmission` (see engine/light/surface_shares.h) are shares: each turns this
//          share of the remaining surface into a mirror or into glass. refractive_index is a factor.
// Reach    the part's own file: parts, elements and sensors that were inserted at the part keep their look.
// Several  material and foliage elements on one part act together: factors multiply, emissions add up, and each share
//          of mirror or glass applies to the surface that the elements before it left.
// Special  Roughness and emission have no effect on unlit materials, which show their colour only.
#include <algorithm>

#include <simvis/element.h>
#include <simvis/node.h>
#include "scenegraph/clone_graph.h"
#include "scenegraph/language/attribute_rows.h"

namespace simvis {
namespace {

class MaterialElement : public Element {
 public:
  /// Throws InputError at the attribute if the part does not exist, has no materials or has no material of that name.
  explicit MaterialElement(const ElementContext& context);
  void update(ParameterView values) override;

 private:
  // A material of the part, and the number of this element's change in it.
  struct Changed {
    std::shared_ptr<MaterialNode> node;
    std::size_t number;
  };
  std::vector<Changed> changed_;
  MaterialChange change_;
};

// Products of a few of these limits and a light's intensity are finite as float32.
constexpr double kMaxFactor = 1000, kMaxEmission = 1e12;
constexpr double kMaxGain = 1e9;  // far above the gain of corner cubes

AttributeRows<MaterialChange> material_rows() {
  using Change = MaterialChange;
  constexpr AttributeLimits kFactor{.min = 0, .max = kMaxFactor}, kShare{.min = 0, .max = 1};
  return {AttributeSpec{.name = "part", .kind = AttributeKind::part, .text = "required: the part to change"},
          AttributeSpec{.name = "material",
                        .kind = AttributeKind::text,
                        .text = "only materials of this name in the part's file; default: all materials"},
          color_rows(&Change::color, "", kFactor, "factor of the file's base colour, linear"),
          row(&Change::opacity, "opacity", "", kShare,
              "factor of the file's opacity; below 0.5 depth cameras and scanners see through; 0: not drawn")
              .live(),
          row(&Change::roughness, "roughness", "", kShare,
              "factor of the file's roughness, which is 1 by default; 1 is matte, 0 is polished")
              .live(),
          color_rows(&Change::emission, "emission_", {.min = 0, .max = kMaxEmission},
                     "linear radiance, added to the file's"),
          row(&Change::fixed_opacity, "fixed_opacity", "", kShare,
              "opacity in place of the file's, before the factor `opacity` applies; default: the file's"),
          row(&Change::reflectance, "reflectance", "", kShare,
              "share of laser light that is reflected; default: the mean of the linear base colour"),
          row(&Change::retro_reflectance, "retro_reflectance", "", {.min = 0, .max = kMaxGain},
              "gain of a retro-reflector for lasers, pi R_A; a white matte wall is 1; default: no retro-reflector"),
          row(&Change::mirror, "mirror", "", kShare,
              "lasers and paths of light: share of the remaining surface that becomes a mirror")
              .live(),
          row(&Change::transmission, "transmission", "", kShare,
              "lasers and paths of light: share of the remaining surface that becomes a thin pane of glass")
              .live(),
          row(&Change::refractive_index, "refractive_index", "", {.min = 0.1, .max = 10},
              "factor of the file's refractive index, which is 1.5 by default")
              .live()};
}
const AttributeRows<MaterialChange> kMaterialRows = material_rows();

const ElementRegistration kMaterialRegistration({
    .name = "material",
    .summary = "Changes how one part looks and how it reflects laser light.",
    .notes = "Other parts from the same file keep their look. An attribute that is not given leaves the file's value. "
             "Roughness and emission have no effect on unlit materials.",
    .attributes = kMaterialRows.table(),
    .create = create_element<MaterialElement>,
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

MaterialElement::MaterialElement(const ElementContext& context) : change_(kMaterialRows.read(context.attributes)) {
  const AttributeValues& attributes = context.attributes;
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
  kMaterialRows.set(change_, values);
  for (const Changed& changed : changed_) changed.node->set_change(changed.number, change_);
}

}  // namespace simvis
