#include "scenegraph/part_objects.h"

#include <memory>
#include <unordered_set>

namespace simvis {
namespace {

// Numbers as PartObject::parent has them.
struct Around {
  std::size_t object = 0,  // the last one before a node
      model = 0;           // the last one that is a model
};

struct Level {
  Group* group;
  std::size_t next = 0;  // the child to visit
  Around saved;          // when the group began
};

}  // namespace

std::vector<PartObject> part_objects(const NodePtr& root) {
  std::vector<PartObject> found;
  std::unordered_set<const Node*> seen;
  std::vector<Level> path;
  Around around;
  const auto enter = [&](const NodePtr& node) {
    auto* const group = dynamic_cast<Group*>(node.get());
    if (group != nullptr && seen.insert(group).second) path.push_back({.group = group, .saved = around});
  };
  enter(root);
  while (!path.empty()) {
    Level& level = path.back();
    if (level.next == level.group->children().size()) {
      const NodeKind kind = level.group->kind();
      if (kind == NodeKind::separator || kind == NodeKind::visual) around = level.saved;
      path.pop_back();
      continue;
    }
    const NodePtr& node = level.group->children()[level.next++];
    if (node->kind() != NodeKind::insertion_point) {
      enter(node);
      continue;
    }
    auto* const point = static_cast<InsertionPoint*>(node.get());
    const bool is_frame = point->object_kind == ObjectKind::frame;
    found.push_back({.group = level.group, .point = point, .parent = is_frame ? level.saved.object : around.model});
    around.object = found.size();
    if (point->object_kind == ObjectKind::model) around.model = found.size();
  }
  return found;
}

}  // namespace simvis
