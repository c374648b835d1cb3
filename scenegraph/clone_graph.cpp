#include "scenegraph/clone_graph.h"

#include <unordered_set>

#include "engine/base/assert.h"

namespace simvis {
namespace {

// Copies the node without its children.
NodePtr copy_of(const Node& node) {
  switch (node.kind()) {
    case NodeKind::group:
      return std::make_shared<Group>();
    case NodeKind::separator:
      return std::make_shared<Separator>();
    case NodeKind::visual:
      return std::make_shared<VisualSeparator>();
    case NodeKind::switch_:
      return std::make_shared<Switch>();
    case NodeKind::transform:
      return std::make_shared<Transform>(static_cast<const Transform&>(node).matrix());
    case NodeKind::material:
      return std::make_shared<MaterialNode>(static_cast<const MaterialNode&>(node).material());
    case NodeKind::visibility: {
      const auto copy = std::make_shared<Visibility>();
      copy->set_visible(static_cast<const Visibility&>(node).visible());
      return copy;
    }
    case NodeKind::shape:
      return std::make_shared<Shape>(static_cast<const Shape&>(node).mesh());
    case NodeKind::light: {
      const auto& light = static_cast<const LightNode&>(node);
      const auto copy = std::make_shared<LightNode>(light.light());
      copy->set_tint(light.tint());
      return copy;
    }
    case NodeKind::environment:
      return std::make_shared<EnvironmentNode>(static_cast<const EnvironmentNode&>(node).environment());
    case NodeKind::sky: {
      const SkyView& view = static_cast<const SkyNode&>(node).view();
      const auto copy = std::make_shared<SkyNode>(view.picture, view.mean);
      copy->set_factor(view.factor);
      return copy;
    }
    case NodeKind::medium:
      return std::make_shared<MediumNode>(static_cast<const MediumNode&>(node).medium());
    case NodeKind::insertion_point:
      return std::make_shared<InsertionPoint>(static_cast<const InsertionPoint&>(node).object_kind);
    case NodeKind::mount:
      return std::make_shared<Mount>();
  }
  SIMVIS_ASSERT(!"a node of unknown kind");
  return nullptr;
}

}  // namespace

std::vector<NodePtr> nodes_of(const NodePtr& root) {
  std::vector<NodePtr> nodes{root};
  std::unordered_set<const Node*> seen{root.get()};
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto group = std::dynamic_pointer_cast<const Group>(nodes[i]);
    if (group == nullptr) continue;
    for (const NodePtr& child : group->children()) {
      if (seen.insert(child.get()).second) nodes.push_back(child);
    }
  }
  return nodes;
}

NodePtr clone_graph(const NodePtr& root, NodeMap& clone_of) {
  const std::vector<NodePtr> nodes = nodes_of(root);
  for (const NodePtr& node : nodes) {
    const NodePtr copy = copy_of(*node);
    copy->name = node->name;
    clone_of[node.get()] = copy;
  }
  for (const NodePtr& node : nodes) {
    const auto group = std::dynamic_pointer_cast<const Group>(node);
    if (group == nullptr) continue;
    const auto copy = std::static_pointer_cast<Group>(clone_of.at(node.get()));
    for (const NodePtr& child : group->children()) copy->add(clone_of.at(child.get()));
    if (group->kind() == NodeKind::switch_) {
      std::static_pointer_cast<Switch>(copy)->set_which(static_cast<const Switch&>(*group).which());
    }
  }
  return clone_of.at(root.get());
}

}  // namespace simvis
