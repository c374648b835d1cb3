#include "program/live/named_transforms.h"

#include "scenegraph/graph_walk.h"

namespace simvis::live {
namespace {

class TransformWalk {
 public:
  explicit TransformWalk(const BuiltScene& built) : built_(built) {
    for (const ElementDescriptor& element : built.parameters.elements()) {
      if (element.removed) continue;
      const NodePtr node = built.scene.find_node(element.name);
      if (node != nullptr) elements_.emplace(node.get(), element.name);
    }
    for (std::size_t i = 0; i < built.sensors.size(); ++i) mounts_.emplace(built.sensors[i].mount.get(), i);
    found_.sensors.resize(built.sensors.size());
  }

  NamedTransforms take() {
    const Group& root = *built_.scene.root();
    walk_graph(root, {.visit = [this](const Node& node, const WalkState&) { visit(node); },
                      .leave = [this](const Group& group) { leave(group); }});
    return std::move(found_);
  }

 private:
  void visit(const Node& node) {
    if (node.kind() == NodeKind::visual) ++visual_depth_;
    if (visual_depth_ > 0) return;
    switch (node.kind()) {
      case NodeKind::group:
      case NodeKind::separator:
      case NodeKind::switch_:
        open_groups_.push_back({&node, entry_});
        break;
      case NodeKind::transform:
        entry_ = ++entries_;
        if (const auto element = elements_.find(&node); element != elements_.end()) {
          found_.elements.emplace(element->second, entry_);
        }
        break;
      case NodeKind::insertion_point:
        found_.points.emplace(node.name, entry_);
        break;
      case NodeKind::mount:
        if (const auto mount = mounts_.find(&node); mount != mounts_.end() && !found_.sensors[mount->second]) {
          found_.sensors[mount->second] = entry_;
        }
        break;
      default:
        break;
    }
  }

  void leave(const Group& group) {
    if (group.kind() == NodeKind::visual) {
      --visual_depth_;
      return;
    }
    if (visual_depth_ > 0) return;
    // Transforms in a separator end with it; those in another group go on, as in the flattener.
    const std::uint32_t before = open_groups_.back().second;
    open_groups_.pop_back();
    if (group.kind() == NodeKind::separator || open_groups_.empty()) entry_ = before;
  }

  const BuiltScene& built_;
  NamedTransforms found_;
  std::map<const Node*, std::string_view> elements_;
  std::map<const Node*, std::size_t> mounts_;
  std::vector<std::pair<const Node*, std::uint32_t>> open_groups_;
  std::uint32_t entry_ = 0, entries_ = 0;  // in force; made so far, without the identity
  int visual_depth_ = 0;
};

}  // namespace

NamedTransforms named_transforms(const BuiltScene& built) { return TransformWalk(built).take(); }

}  // namespace simvis::live
