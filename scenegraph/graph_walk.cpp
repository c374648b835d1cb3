#include "scenegraph/graph_walk.h"

#include <vector>

namespace simvis {
namespace {

// A group on the path from the root to the current node.
struct WalkLevel {
  const Group* group;
  std::size_t next, end;  // children still to visit
  WalkState saved;
};

WalkLevel level_of(const Group& group, const WalkState& state) {
  WalkLevel level{&group, 0, group.children().size(), state};
  if (group.kind() != NodeKind::switch_) return level;
  const int which = static_cast<const Switch&>(group).which();
  if (which == Switch::kNone) level.end = 0;
  if (which >= 0) level = {&group, static_cast<std::size_t>(which), static_cast<std::size_t>(which) + 1, state};
  return level;
}

void apply(const Node& node, WalkState& state) {
  if (node.kind() == NodeKind::transform) {
    state.world_from_node = state.world_from_node * static_cast<const Transform&>(node).matrix();
  } else if (node.kind() == NodeKind::material) {
    state.material = static_cast<const MaterialNode*>(&node);
  } else if (node.kind() == NodeKind::visibility) {
    state.visible = state.visible && static_cast<const Visibility&>(node).visible();
  }
}

}  // namespace

void walk_graph(const Group& root, const GraphVisitor& visitor) {
  WalkState state;
  visitor.visit(root, state);
  std::vector<WalkLevel> path{level_of(root, state)};
  while (!path.empty()) {
    WalkLevel& level = path.back();
    if (level.next == level.end) {
      const NodeKind kind = level.group->kind();
      if (kind == NodeKind::separator || kind == NodeKind::visual) state = level.saved;
      if (visitor.leave) visitor.leave(*level.group);
      path.pop_back();
      continue;
    }
    const Node& node = *level.group->children()[level.next++];
    apply(node, state);
    visitor.visit(node, state);
    if (const auto* const group = dynamic_cast<const Group*>(&node)) path.push_back(level_of(*group, state));
  }
}

}  // namespace simvis
