#include "elements/shape_selection.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include <fnmatch.h>

#include "scenegraph/clone_graph.h"
#include "scenegraph/flattener.h"

namespace simvis {
namespace {

constexpr std::string_view kWorld = "ROOT";
constexpr std::size_t kMaxListedNames = 20;  // in a message

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

// Names that match the attribute, itself or as a pattern. Throws if there are none. `thing` is what has the names.
SelectedNames matching_names(const ElementContext& context, const char* attribute, const SelectedNames& known,
                             std::string_view kind, std::string_view thing) {
  const std::string& wanted = context.attributes.text(attribute);
  if (known.contains(wanted)) return {wanted};
  SelectedNames matching;
  std::ranges::copy_if(known, std::inserter(matching, matching.end()),
                       [&](const std::string& name) { return matches(wanted, name); });
  if (!matching.empty()) return matching;
  const std::vector<std::string_view> names(known.begin(), known.end());
  std::string list;
  for (std::size_t i = 0; i < std::min(names.size(), kMaxListedNames); ++i) {
    list += (list.empty() ? "" : ", ") + std::string(names[i]);
  }
  if (known.size() > kMaxListedNames) list += " and " + std::to_string(known.size() - kMaxListedNames) + " more";
  fail_at(context.attributes.where(attribute), "there is no " + std::string(thing) + " " + in_quotes(wanted) +
                                                   " in what the " + std::string(kind) + " names" +
                                                   suggestion(wanted, names) +
                                                   (list.empty() ? " (no " + std::string(thing) + " of it has a name)"
                                                                 : " (expected one of: " + list + ", or a pattern)"));
}

// The shapes that the attribute names. Leaves only points that have such shapes.
SelectedNames selected_names(const ElementContext& context, SelectedNames& points, std::string_view kind) {
  if (!context.attributes.is_set("shapes")) return {};
  Flattener flattener(context.scene.root());
  flattener.update();
  SelectedNames known;
  std::map<std::string, SelectedNames, std::less<>> points_of_name;
  for (const ItemSource& source : flattener.item_sources()) {
    if (source.point == nullptr || !points.contains(source.point->name)) continue;
    for (const std::string_view name : flattener.names_of(source)) {
      known.emplace(name);
      points_of_name[std::string(name)].insert(source.point->name);
    }
  }
  SelectedNames names = matching_names(context, "shapes", known, kind, "shape");
  points.clear();
  for (const std::string& name : names) points.insert(points_of_name[name].begin(), points_of_name[name].end());
  return names;
}

// The materials of the points' files and shapes that the attribute names.
SelectedNames selected_materials(const ElementContext& context, const SelectedNames& of_points, std::string_view kind) {
  if (!context.attributes.is_set("material")) return {};
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
  return matching_names(context, "material", known, kind, "material");
}

// A name that both have; the empty name if they have none of their own; nothing if only one of them has names, or if
// these differ.
std::optional<std::string> shared_name(const SelectedNames& a, const SelectedNames& b) {
  if (a.empty() && b.empty()) return "";
  const auto shared = std::ranges::find_if(a, [&](const std::string& name) { return b.contains(name); });
  return shared == a.end() ? std::nullopt : std::optional(*shared);
}

}  // namespace

ShapeSelection selected_shapes(const ElementContext& context, std::string_view kind) {
  ShapeSelection selection{.points = selected_points(context, kind), .names = {}, .materials = {}};
  selection.names = selected_names(context, selection.points, kind);
  selection.materials = selected_materials(context, selection.points, kind);
  return selection;
}

Location selection_place(const ElementContext& context) {
  const AttributeValues& attributes = context.attributes;
  return attributes.is_set("part")    ? attributes.where("part")
         : attributes.is_set("parts") ? attributes.where("parts")
                                      : context.command.where;
}

std::string SharedShapes::which() const {
  if (name.empty() && material.empty()) return "";
  const std::string of_name = name.empty() ? "" : "the shapes " + in_quotes(name);
  const std::string of_material = material.empty() ? "" : "the material " + in_quotes(material);
  return " for " + of_name + (name.empty() || material.empty() ? "" : " and ") + of_material;
}

std::optional<SharedShapes> shared_shapes(const ShapeSelection& a, const ShapeSelection& b) {
  const std::optional<std::string> name = shared_name(a.names, b.names),
                                   material = shared_name(a.materials, b.materials);
  if (!name || !material) return {};
  const auto point = std::ranges::find_if(a.points, [&](const std::string& each) { return b.points.contains(each); });
  if (point == a.points.end()) return {};
  return SharedShapes{.point = *point, .name = *name, .material = *material};
}

}  // namespace simvis
