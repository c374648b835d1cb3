#include "elements/visibility_flags.h"

#include <memory>
#include <optional>
#include <utility>

namespace simvis {
namespace {

constexpr AttributeSpec kVisibilityFlagsRows[] = {
    {.name = "flags",
     .kind = AttributeKind::integer,
     .text = "required: 32 bits; a sensor sees the shapes if its visibility_mask has one of them; 0: no sensor does",
     .min = 0,
     .max = kAllVisibilityFlags},
};

const ElementRegistration kVisibilityFlagsRegistration({
    .name = "visibility_flags",
    .summary = "Says which sensors see the shapes of parts: those whose visibility_mask shares a bit with the flags.",
    .notes = "Shapes without flags have all bits. The element with the nearest name of a shape takes precedence, then "
             "one with a material, over one of the whole part. What is inserted at a part later belongs to other "
             "parts. Shadows do not depend on flags.",
    .attributes = with_selection_rows(kVisibilityFlagsRows),
    .create = create_element<VisibilityFlagsElement>,
});

// Holds the flags in the scene graph, so that they leave the scene with their element.
class FlagsNode : public Separator {
 public:
  explicit FlagsNode(VisibilityFlags flags) : flags_(std::move(flags)) {}
  const VisibilityFlags& flags() const { return flags_; }

 private:
  VisibilityFlags flags_;
};

void check_without_flags(const ElementContext& context, const ShapeSelection& shapes) {
  for (const VisibilityFlags* const other : visibility_flags_of(context.scene)) {
    const std::optional<SharedShapes> shared = shared_shapes(shapes, other->shapes);
    if (!shared) continue;
    fail_at(selection_place(context), in_quotes(shared->point) + " already has visibility flags from element " +
                                          in_quotes(other->element) + shared->which() +
                                          ", expected one element for each part");
  }
}

}  // namespace

std::vector<const VisibilityFlags*> visibility_flags_of(const Scene& scene) {
  std::vector<const VisibilityFlags*> all;
  for (const NodePtr& child : scene.root()->children()) {
    if (const auto* const node = dynamic_cast<const FlagsNode*>(child.get())) all.push_back(&node->flags());
  }
  return all;
}

VisibilityFlagsElement::VisibilityFlagsElement(const ElementContext& context) {
  context.command.require("flags");
  VisibilityFlags flags{.element = context.command.require("name").value,
                        .flags = static_cast<std::uint32_t>(context.attributes.integer("flags")),
                        .shapes = selected_shapes(context, "visibility_flags")};
  check_without_flags(context, flags.shapes);
  context.scene.insert_in_world(context.command, std::make_shared<FlagsNode>(std::move(flags)));
}

}  // namespace simvis
