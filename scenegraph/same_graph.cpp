#include "scenegraph/same_graph.h"

#include <unordered_map>

#include "scenegraph/clone_graph.h"

namespace simvis {
namespace {

template <typename T>
const T& as(const NodePtr& node) {
  return static_cast<const T&>(*node);
}

// Compares the nodes without their children.
bool same_node(const NodePtr& a, const NodePtr& b) {
  if (a->kind() != b->kind()) return false;
  switch (a->kind()) {
    case NodeKind::group:
    case NodeKind::separator:
    case NodeKind::visual:
    case NodeKind::mount:
      return true;
    case NodeKind::insertion_point:
      return as<InsertionPoint>(a).object_kind == as<InsertionPoint>(b).object_kind;
    case NodeKind::switch_:
      return as<Switch>(a).which() == as<Switch>(b).which();
    case NodeKind::transform:
      return as<Transform>(a).matrix() == as<Transform>(b).matrix();
    case NodeKind::material:
      return as<MaterialNode>(a).material() == as<MaterialNode>(b).material();
    case NodeKind::visibility:
      return as<Visibility>(a).visible() == as<Visibility>(b).visible();
    case NodeKind::shape:
      return as<Shape>(a).mesh() == as<Shape>(b).mesh();
    case NodeKind::light:
      return as<LightNode>(a).light() == as<LightNode>(b).light() && as<LightNode>(a).tint() == as<LightNode>(b).tint();
    case NodeKind::environment:
      return as<EnvironmentNode>(a).environment() == as<EnvironmentNode>(b).environment();
    case NodeKind::sky:
      return as<SkyNode>(a).view() == as<SkyNode>(b).view();
    case NodeKind::medium:
      return as<MediumNode>(a).medium() == as<MediumNode>(b).medium();
  }
  return false;
}

using Numbers = std::unordered_map<const Node*, std::size_t>;

Numbers numbered(const std::vector<NodePtr>& nodes) {
  Numbers numbers;
  for (std::size_t i = 0; i < nodes.size(); ++i) numbers.emplace(nodes[i].get(), i);
  return numbers;
}

bool same_children(const NodePtr& a, const NodePtr& b, const Numbers& numbers_a, const Numbers& numbers_b) {
  const auto group_a = std::dynamic_pointer_cast<const Group>(a), group_b = std::dynamic_pointer_cast<const Group>(b);
  if (group_a == nullptr) return true;
  const std::vector<NodePtr>&children_a = group_a->children(), &children_b = group_b->children();
  if (children_a.size() != children_b.size()) return false;
  for (std::size_t i = 0; i < children_a.size(); ++i) {
    if (numbers_a.at(children_a[i].get()) != numbers_b.at(children_b[i].get())) return false;
  }
  return true;
}

}  // namespace

bool same_graph(const NodePtr& a, const NodePtr& b) {
  const std::vector<NodePtr> nodes_a = nodes_of(a), nodes_b = nodes_of(b);
  if (nodes_a.size() != nodes_b.size()) return false;
  const Numbers numbers_a = numbered(nodes_a), numbers_b = numbered(nodes_b);
  for (std::size_t i = 0; i < nodes_a.size(); ++i) {
    if (!same_node(nodes_a[i], nodes_b[i]) || nodes_a[i]->name != nodes_b[i]->name) return false;
    if (!same_children(nodes_a[i], nodes_b[i], numbers_a, numbers_b)) return false;
  }
  return true;
}

}  // namespace simvis
