#include "elements/mimic_joint.h"

#include <simvis/node.h>
#include <simvis/pose.h>
#include "elements/joint.h"
#include "elements/joint_motion.h"

namespace simvis {
namespace {

constexpr AttributeSpec kMimicRows[] = {
    {.name = "leader",
     .kind = AttributeKind::element,
     .text = "required: the joint that this one follows; it stands before this one in the scene"},
    {.name = "multiplier",
     .kind = AttributeKind::number,
     .default_value = "1",
     .unit = "1, m/deg or deg/m",
     .text = "value = multiplier * leader + offset",
     .min = -kMaxCoordinate_m,
     .max = kMaxCoordinate_m},
    {.name = "offset",
     .kind = AttributeKind::number,
     .default_value = "0",
     .unit = "deg or m",
     .text = "value where the leader's value is 0",
     .min = -kMaxCoordinate_m,
     .max = kMaxCoordinate_m},
};

const ElementRegistration kMimicJointRegistration({
    .name = "mimic_joint",
    .summary = "A joint that follows another joint: its value is multiplier * leader + offset.",
    .attributes = AttributeRows<JointMotion>{AttributeTable(kMimicRows), rows_of<JointMotion>()}.table(),
    .create = create_element<MimicJointElement>,
});

}  // namespace

MimicJointElement::MimicJointElement(const ElementContext& context) {
  const AttributeValues& attributes = context.attributes;
  const CommandAttribute& leader_name = context.command.require("leader");
  auto* leader = dynamic_cast<JointElement*>(context.find_element(leader_name.value));
  if (leader == nullptr) {
    fail_at(leader_name.where, "attribute \"leader\": " + in_quotes(leader_name.value) +
                                   " is not allowed, expected the name of an element of type joint");
  }
  const auto motion = rows_of<JointMotion>().read(attributes);
  law_ = {.leader = leader_name.value,
          .multiplier = attributes.number("multiplier"),
          .offset = attributes.number("offset"),
          .slides = !motion.revolute};
  const auto transform = std::make_shared<Transform>();
  transform->name = context.command.require("name").value;
  context.scene.insert(context.command, transform);
  const auto follow = [leader, transform, motion, law = law_] {
    return leader->follow([=](double value) { transform->set_matrix(motion.at(law.multiplier * value + law.offset)); });
  };
  const auto number = std::make_shared<std::size_t>(follow());
  context.scene.undo().add([leader, number] { leader->unfollow(*number); }, [follow, number] { *number = follow(); });
}

}  // namespace simvis
