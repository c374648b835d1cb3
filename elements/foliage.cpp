#include "elements/foliage.h"
#include "scenegraph/clone_graph.h"

namespace simvis {
namespace {

constexpr AttributeSpec kFoliageAttributes[] = {
    {.name = "part",
     .kind = AttributeKind::part,
     .text = "required: the part whose masked and blended materials are leaves"},
    {.name = "transparency",
     .default_value = "0",
     .unit = "%",
     .text = "0: as in the file; depth sensors see through leaves above 50; 100: leaves are not drawn",
     .min = 0,
     .max = 100,
     .live = true},
};

const ElementRegistration kFoliageRegistration({
    .name = "foliage",
    .summary = "Fades the leaves of a part: its masked and blended materials.",
    .notes =
        "Depth cameras and laser scanners see masked leaves up to a transparency of 50 %. At 100 % nothing is drawn.",
    .attributes = kFoliageAttributes,
    .create = create_element<FoliageElement>,
});

}  // namespace

FoliageElement::FoliageElement(const ElementContext& context) {
  const CommandAttribute& part = context.command.require("part");
  // An empty node that marks the position of the element in the graph.
  context.scene.insert(context.command, std::make_shared<Separator>());
  for (const NodePtr& node : nodes_of(context.scene.own_part(part.value, part.where).root)) {
    if (node->kind() != NodeKind::material) continue;
    const auto material = std::static_pointer_cast<MaterialNode>(node);
    if (material->material()->alpha_mode == AlphaMode::opaque) continue;
    const std::size_t number = material->add_change();
    leaves_.push_back({material, number});
    context.scene.undo().add([material, number] { material->remove_change(number); },
                             [material, number] { material->restore_change(number); });
  }
  if (leaves_.empty()) {
    fail_at(part.where, "part " + in_quotes(part.value) +
                            " has no leaves, expected a part with materials of the alpha mode MASK or BLEND");
  }
}

void FoliageElement::update(ParameterView values) {
  const MaterialChange change{.opacity = static_cast<float>(1 - values[0] / 100)};
  for (const Leaves& leaves : leaves_) leaves.material->set_change(leaves.number, change);
}

}  // namespace simvis
