// The element `foliage`: fades the leaves of a part, to show what they hide and how they affect a sensor.
//
//   <element type="foliage" name="LEAVES" insert_at="ROOT" part="TREE" transparency="60"/>
//
// Leaves   All materials of the part with the alpha mode mask or blend count as leaves, because leaves are usually cut
//          out of a picture. Opaque materials, such as those of trunks, do not change. Parts that were inserted at the
//          tree keep their leaves. The factors of several elements on one part multiply.
// Parameters  transparency (live), in %. At 0 leaves look as in the file. Between 0 and 100 a masked leaf is blended:
//          each texel that passes the alpha cutoff covers 1 - transparency of the background. A blended leaf covers its
//          alpha times that share. Depth cameras and scanners measure a leaf that covers at least one half. At 100
//          leaves are not drawn.
#include <simvis/element.h>
#include <simvis/node.h>
#include "scenegraph/clone_graph.h"

namespace simvis {
namespace {

class FoliageElement : public Element {
 public:
  /// Throws InputError at the attribute if the part does not exist or has no masked or blended materials.
  explicit FoliageElement(const ElementContext& context);
  void update(ParameterView values) override;

 private:
  // A leaf material, and the number of this element's change in it.
  struct Leaves {
    std::shared_ptr<MaterialNode> material;
    std::size_t number;
  };
  std::vector<Leaves> leaves_;
};

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
