#include "elements/frame.h"

#include <memory>

#include <simvis/node.h>
#include "scenegraph/language/frame_name.h"

namespace simvis {
namespace {

constexpr AttributeSpec kFrameAttributes[] = {
    {.name = "frame",
     .kind = AttributeKind::text,
     .text = "required: the frame_id in messages, such as base_link; no '/' in front and no spaces"},
};

const ElementRegistration kFrameRegistration({
    .name = "frame",
    .summary = "Names the frame of its insertion point in ROS messages and puts it into the tree of transforms.",
    .notes = "Without it, the frame of a part that carries sensors has the part's name, and the world's is \"map\". At "
             "ROOT it renames the world's frame.",
    .attributes = kFrameAttributes,
    .create = create_element<FrameElement>,
});

}  // namespace

FrameElement::FrameElement(const ElementContext& context)
    : point_(context.command.require("insert_at").value),
      frame_(context.command.require("frame").value),
      where_(context.command.require("frame").where) {
  check_frame_name(context.command.require("frame"));
  // An empty group: the scene checks the insertion point and takes the element out with what stands there.
  const auto mark = std::make_shared<Group>();
  mark->name = context.command.require("name").value;
  context.scene.insert(context.command, mark);
}

}  // namespace simvis
