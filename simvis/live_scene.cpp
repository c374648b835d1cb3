#include "simvis/live_scene.h"

#include <algorithm>
#include <utility>

#include "scenegraph/clone_graph.h"
#include "simvis/default_light.h"

namespace simvis {
namespace {

// An invalid override is an error even if the scene has no sensor of the type.
std::vector<AttributeOverride> checked(std::vector<AttributeOverride> overrides) {
  for (const AttributeOverride& each : overrides) {
    const SensorType* const type = find_sensor_type(each.sensor_type);
    if (type == nullptr) continue;  // the builder reports unknown types and lists the known ones
    const Location where{.file = each.origin.empty() ? each.sensor_type + "." + each.attribute : each.origin};
    Command command{.kind = CommandKind::sensor, .attributes = {}, .where = where, .folder = {}};
    if (each.value) command.attributes.push_back({each.attribute, *each.value, where});
    AttributeValues values(command, type->attributes, {});
  }
  return overrides;
}

}  // namespace

LiveScene::LiveScene(std::vector<AttributeOverride> overrides, std::span<const Command> commands, std::uint64_t seed,
                     ProgressCallback progress, bool strict)
    : overrides_(checked(std::move(overrides))),
      builder_(built, overrides_, seed, std::move(progress)),
      default_light_(std::make_shared<Switch>()) {
  default_light_->add(std::make_shared<LightNode>(kDefaultLight));
  built.scene.insert_in_world(default_light_);
  built.scene.undo().commit();
  if (strict) built.scene.make_strict();
  execute(commands);
}

void LiveScene::execute(std::span<const Command> commands) {
  builder_.execute(commands);
  default_light_->set_which(declares_light() ? Switch::kNone : Switch::kAll);
}

// Whether the scene declares a light itself, even if a switch currently hides it.
bool LiveScene::declares_light() const {
  const Node* const own = default_light_->children().front().get();
  return std::ranges::any_of(nodes_of(built.scene.root()), [own](const NodePtr& node) {
    return node->kind() == NodeKind::light && node.get() != own;
  });
}

}  // namespace simvis
