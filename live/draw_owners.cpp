#include "live/draw_owners.h"

#include "scenegraph/graph_walk.h"

namespace simvis::live {
namespace {

class OwnerWalk {
 public:
  explicit OwnerWalk(const BuiltScene& built) : built_(built) {
    for (const std::string_view name : built.scene.part_names()) {
      parts_.emplace(built.scene.find_node(name).get(), name);
    }
    for (const ElementDescriptor& element : built.parameters.elements()) {
      if (element.removed) continue;
      const NodePtr node = built.scene.find_node(element.name);
      if (node != nullptr) elements_.emplace(node.get(), element.name);
    }
    for (std::size_t i = 0; i < built.sensors.size(); ++i) mounts_.emplace(built.sensors[i].mount.get(), i);
    owners_.sensors.resize(built.sensors.size());
  }

  DrawOwners take() {
    const Group& root = *built_.scene.root();
    open_parts_.push_back(root.name);
    walk_graph(root, {.visit = [this](const Node& node, const WalkState& state) { visit(node, state); },
                      .leave = [this](const Group& group) { leave(group); }});
    return std::move(owners_);
  }

 private:
  void visit(const Node& node, const WalkState& state) {
    if (node.kind() == NodeKind::visual) ++visual_depth_;
    if (visual_depth_ > 0) return;
    if (const auto part = parts_.find(&node); part != parts_.end()) open_parts_.push_back(part->second);
    if (const auto element = elements_.find(&node); element != elements_.end()) enter(node, element->second);
    switch (node.kind()) {
      case NodeKind::group:
      case NodeKind::separator:
      case NodeKind::switch_:
        open_groups_.push_back({&node, entry_});
        break;
      case NodeKind::transform:
        entry_ = ++entries_;
        if (const auto element = elements_.find(&node); element != elements_.end()) {
          owners_.elements.emplace(element->second, entry_);
        }
        break;
      case NodeKind::shape:
        if (!state.visible) break;
        owners_.items.push_back(
            {std::string(open_parts_.back()), open_elements_.empty() ? "" : std::string(open_elements_.back().second)});
        break;
      case NodeKind::insertion_point:
        owners_.points.emplace(node.name, entry_);
        break;
      case NodeKind::mount:
        if (const auto mount = mounts_.find(&node); mount != mounts_.end() && !owners_.sensors[mount->second]) {
          owners_.sensors[mount->second] = entry_;
        }
        break;
      default:
        break;
    }
  }

  void enter(const Node& node, std::string_view element) {
    if (dynamic_cast<const Group*>(&node) != nullptr) open_elements_.emplace_back(&node, element);
  }

  void leave(const Group& group) {
    if (group.kind() == NodeKind::visual) {
      --visual_depth_;
      return;
    }
    if (visual_depth_ > 0) return;
    if (parts_.contains(&group)) open_parts_.pop_back();
    if (!open_elements_.empty() && open_elements_.back().first == &group) open_elements_.pop_back();
    // Transforms in a separator end with it; those in another group go on, as in the flattener.
    const std::uint32_t before = open_groups_.back().second;
    open_groups_.pop_back();
    if (group.kind() == NodeKind::separator || open_groups_.empty()) entry_ = before;
  }

  const BuiltScene& built_;
  DrawOwners owners_;
  std::map<const Node*, std::string_view> parts_, elements_;
  std::map<const Node*, std::size_t> mounts_;
  std::vector<std::string_view> open_parts_;
  std::vector<std::pair<const Node*, std::string_view>> open_elements_;
  std::vector<std::pair<const Node*, std::uint32_t>> open_groups_;
  std::uint32_t entry_ = 0, entries_ = 0;  // in force; made so far, without the identity
  int visual_depth_ = 0;
};

}  // namespace

DrawOwners draw_owners(const BuiltScene& built) { return OwnerWalk(built).take(); }

}  // namespace simvis::live
