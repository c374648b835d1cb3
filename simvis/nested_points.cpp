#include "simvis/nested_points.h"

#include <map>
#include <string_view>

#include "scenegraph/graph_walk.h"

namespace simvis {

std::vector<NestedPoint> nested_points(const Scene& scene, std::span<const std::string> names) {
  std::map<std::string_view, std::size_t> places;
  for (std::size_t i = 0; i < names.size(); ++i) places.emplace(names[i], i);
  const auto place_of = [&](const Node& node) -> std::optional<std::size_t> {
    if (node.kind() != NodeKind::insertion_point) return std::nullopt;
    const auto place = places.find(node.name);
    return place == places.end() ? std::nullopt : std::optional(place->second);
  };
  std::vector<NestedPoint> found(names.size());
  std::optional<std::size_t> now;
  std::vector<std::optional<std::size_t>> saved;
  const auto saves = [](const Node& node) {
    return node.kind() == NodeKind::separator || node.kind() == NodeKind::visual;
  };
  // All of a group belongs to the point in it, also what stands in front of the point.
  const auto enter = [&](const Group& group, const WalkState& state) {
    saved.push_back(now);
    const std::optional<std::size_t> around = now;
    for (const NodePtr& child : group.children()) {
      const std::optional<std::size_t> place = place_of(*child);
      if (!place) continue;
      found[*place].world_from_group = state.world_from_node;
      found[*place].above = around;
      now = place;
    }
  };
  walk_graph(*scene.root(), {.visit =
                                 [&](const Node& node, const WalkState& state) {
                                   if (saves(node)) enter(dynamic_cast<const Group&>(node), state);
                                   if (const std::optional<std::size_t> place = place_of(node)) {
                                     found[*place].world_from_point = state.world_from_node;
                                   }
                                 },
                             .leave =
                                 [&](const Group& group) {
                                   if (!saves(group)) return;
                                   now = saved.back();
                                   saved.pop_back();
                                 }});
  return found;
}

}  // namespace simvis
