#include "elements/shape_selection.h"

#include <algorithm>
#include <iterator>
#include <vector>

#include <fnmatch.h>

#include "scenegraph/clone_graph.h"

namespace simvis {
namespace {

constexpr std::string_view kWorld = "ROOT";

bool matches(const std::string& pattern, const std::string& name) {
  return ::fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
}

SelectedNames selected_points(const ElementContext& context, std::string_view kind) {
  const AttributeValues& attributes = context.attributes;
  if (attributes.is_set("part") && attributes.is_set("parts")) {
    fail_at(context.command.where, "attributes \"part\" and \"parts\": expected one of them, not both");
  }
  const Scene& scene = context.scene;
  if (!attributes.is_set("part") && !attributes.is_set("parts")) {
    const CommandAttribute& point = context.command.require("insert_at");
    if (point.value == kWorld) {
      fail_at(context.command.where, "a " + std::string(kind) +
                                         " needs the attribute \"part\" or \"parts\", expected one of them, or a "
                                         "part as insert_at");
    }
    if (scene.has_insertion_point(point.value)) return {point.value};
    fail_at(point.where, "there is no insertion point " + in_quotes(point.value) +
                             suggestion(point.value, scene.insertion_points()));
  }
  if (attributes.is_set("part")) {
    const std::vector<std::string> points = scene.points_of_part(attributes.text("part"));
    return {points.begin(), points.end()};
  }
  const std::string& pattern = attributes.text("parts");
  SelectedNames points;
  for (const std::string_view point : scene.insertion_points()) {
    const std::string name(point);
    if (point != kWorld && matches(pattern, name)) points.insert(name);
  }
  if (points.empty()) {
    fail_at(attributes.where("parts"), "no part or link matches " + in_quotes(pattern) +
                                           ", expected a pattern of names that were inserted before");
  }
  return points;
}

// The materials of the points' files and shapes that the attribute names, or matches as a pattern. Throws if there are
// none.
SelectedNames selected_materials(const ElementContext& context, const SelectedNames& of_points, std::string_view kind) {
  if (!context.attributes.is_set("material")) return {};
  const std::string& wanted = context.attributes.text("material");
  SelectedNames known;
  for (const std::string_view part : context.scene.part_names()) {
    const std::vector<std::string> points = context.scene.points_of_part(part);
    const bool is_selected =
        std::ranges::any_of(points, [&](const std::string& point) { return of_points.contains(point); });
    if (!is_selected) continue;
    for (const NodePtr& node : nodes_of(context.scene.load_part(context.scene.part_command(part)).root)) {
      if (node->kind() == NodeKind::material && !node->name.empty()) known.insert(node->name);
    }
  }
  if (known.contains(wanted)) return {wanted};
  SelectedNames matching;
  std::ranges::copy_if(known, std::inserter(matching, matching.end()),
                       [&](const std::string& name) { return matches(wanted, name); });
  if (!matching.empty()) return matching;
  const std::vector<std::string_view> names(known.begin(), known.end());
  std::string list;
  for (const std::string& name : known) list += (list.empty() ? "" : ", ") + name;
  fail_at(context.attributes.where("material"),
          "there is no material " + in_quotes(wanted) + " in what the " + std::string(kind) + " names" +
              suggestion(wanted, names) +
              (list.empty() ? " (none of its materials has a name)" : " (expected one of: " + list + ")"));
}

}  // namespace

ShapeSelection selected_shapes(const ElementContext& context, std::string_view kind) {
  ShapeSelection selection{.points = selected_points(context, kind), .materials = {}};
  selection.materials = selected_materials(context, selection.points, kind);
  return selection;
}

Location selection_place(const ElementContext& context) {
  const AttributeValues& attributes = context.attributes;
  return attributes.is_set("part")    ? attributes.where("part")
         : attributes.is_set("parts") ? attributes.where("parts")
                                      : context.command.where;
}

std::optional<SharedShapes> shared_shapes(const ShapeSelection& a, const ShapeSelection& b) {
  const auto material =
      std::ranges::find_if(a.materials, [&](const std::string& name) { return b.materials.contains(name); });
  const bool of_all = a.materials.empty() && b.materials.empty();
  if (!of_all && material == a.materials.end()) return {};
  const auto point = std::ranges::find_if(a.points, [&](const std::string& name) { return b.points.contains(name); });
  if (point == a.points.end()) return {};
  return SharedShapes{.point = *point, .material = of_all ? "" : *material};
}

}  // namespace simvis
