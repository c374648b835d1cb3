#include "elements/pose.h"

#include <algorithm>
#include <optional>

#include "elements/pose_rows.h"
#include "engine/base/assert.h"
#include "scenegraph/language/attribute_rows.h"

namespace simvis {
namespace {

constexpr AttributeSpec kMovesRow = {
    .name = "moves",
    .kind = AttributeKind::choice,
    .default_value = "behind",
    .text =
        "behind: what is inserted at the point later, and what stands behind it; all: the whole part or link at the "
        "point, with what was inserted there before, in the frame in which it stands",
    .choices = "behind all"};

AttributeTable pose_attributes() {
  static const AttributeTable table = join_tables({{kMovesRow}, pose_rows()});
  return table;
}

const ElementRegistration kPoseRegistration({
    .name = "pose",
    .summary = "Moves and turns what follows its insertion point.",
    .notes = "x is forward, y left, z up. The rotation is R = Rz(yaw) Ry(pitch) Rx(roll).",
    .attributes = pose_attributes(),
    .create = create_element<PoseElement>,
});

// The group that has a node as its child, switched off or not; null: none has.
Group* find_parent(Group& within, const NodePtr& node) {
  for (const NodePtr& child : within.children()) {
    if (child == node) return &within;
    auto* const group = dynamic_cast<Group*>(child.get());
    if (Group* const found = group == nullptr ? nullptr : find_parent(*group, node)) return found;
  }
  return nullptr;
}

// Moves a node to the front of its group. The group of a part or a link is its own.
void stand_first(const ElementContext& context, const NodePtr& node) {
  const CommandAttribute& at = context.command.require("insert_at");
  const ObjectTree& tree = context.scene.objects();
  const std::optional<std::uint32_t> object = tree.find(at.value);
  if (!object || (tree[*object].kind != ObjectKind::part && tree[*object].kind != ObjectKind::link)) {
    fail_at(at.where, in_quotes(at.value) + " is no part and no link, expected one for a pose that moves all of it");
  }
  Group* const group = find_parent(*context.scene.root(), node);
  SIMVIS_ASSERT(group != nullptr);
  const NodePtr first = group->children().front();
  if (first == node) return;
  group->remove(*node);
  group->insert_before(*first, node);
}

}  // namespace

PoseElement::PoseElement(const ElementContext& context) : transform_(std::make_shared<Transform>()) {
  transform_->name = context.command.require("name").value;
  context.scene.insert(context.command, transform_);
  if (context.attributes.choice("moves") == "all") stand_first(context, transform_);
}

void PoseElement::update(ParameterView values) {
  driver_->current = matrix_of_pose(values);
  driver_->was_set = driver_->was_set || !std::ranges::equal(values, shown_);
  transform_->set_matrix(driver_->current);
}

void PoseElement::advance(std::int64_t time_ns, std::span<double> values) {
  if (!driver_->value) return;
  const glm::dmat4 matrix = driver_->value(time_ns);
  if (driver_->was_set) return;
  write_pose(matrix, values);
  shown_.assign(values.begin(), values.end());
}

}  // namespace simvis
