#include "elements/shape_selection.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "scenegraph/clone_graph.h"
#include "scenegraph/flattener.h"
#include "scenegraph/language/attribute_rows.h"

namespace simvis {
namespace {

constexpr std::size_t kMaxListedNames = 20;  // in a message

constexpr AttributeSpec kSelectionRows[] = {
    {.name = "part",
     .kind = AttributeKind::object,
     .text = "the part, model or link whose shapes are meant; default, without parts: those of insert_at alone"},
    {.name = "parts",
     .kind = AttributeKind::objects,
     .text = "names and patterns of parts, models and links whose shapes are meant: * any text, ? any character"},
    {.name = "shapes",
     .kind = AttributeKind::text,
     .text = "only shapes of this name in their file, or that matches it as a pattern; default: all shapes"},
    {.name = "material",
     .kind = AttributeKind::text,
     .text = "only shapes with a material of this name, or that matches it as a pattern; default: all shapes"}};

// The objects that the attributes name, in the order of the tree.
std::vector<std::uint32_t> named_objects(const ElementContext& context, std::string_view kind) {
  const AttributeValues& attributes = context.attributes;
  if (attributes.is_set("part") && attributes.is_set("parts")) {
    fail_at(context.command.where, "attributes \"part\" and \"parts\": expected one of them, not both");
  }
  if (attributes.is_set("parts")) {
    std::vector<std::uint32_t> found = context.scene.find_objects(attributes.text("parts"), attributes.where("parts"));
    std::ranges::sort(found);
    return found;
  }
  const CommandAttribute& name =
      attributes.is_set("part") ? context.command.require("part") : context.command.require("insert_at");
  const std::uint32_t found =
      context.scene.find_object(attributes.is_set("part") ? "part or link" : "insertion point", name.value, name.where);
  if (context.scene.objects()[found].kind == ObjectKind::world) {
    fail_at(attributes.is_set("part") ? name.where : context.command.where,
            "a " + std::string(kind) +
                " needs the attribute \"part\" or \"parts\", expected one of them, or a part as "
                "insert_at");
  }
  return {found};
}

// The object of this level around another one.
std::uint32_t object_around(const ObjectTree& tree, std::uint32_t object, SelectionLevel level) {
  if (level == SelectionLevel::part) return tree[object].part;
  while (tree[object].kind != ObjectKind::model && tree[object].kind != ObjectKind::part) object = tree[object].parent;
  return object;
}

std::map<std::string, std::string, std::less<>> selected_points(const ElementContext& context, std::string_view kind,
                                                                SelectionLevel level) {
  const ObjectTree& tree = context.scene.objects();
  const bool is_alone = !context.attributes.is_set("part") && !context.attributes.is_set("parts");
  const bool is_lifted = level == SelectionLevel::part || level == SelectionLevel::model;
  std::map<std::string, std::string, std::less<>> points;
  // An object stands behind those that it belongs to, so that the content of a part is not split by what is named in
  // it.
  for (std::uint32_t object : named_objects(context, kind)) {
    if (is_lifted) object = object_around(tree, object, level);
    const std::vector<std::uint32_t> content = is_alone && !is_lifted ? std::vector{object} : tree.content_of(object);
    for (const std::uint32_t each : content) {
      const bool is_own = level == SelectionLevel::link || level == SelectionLevel::shape;
      points.emplace(tree[each].name, tree[is_own ? each : object].name);
    }
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
                       [&](const std::string& name) { return matches_pattern(wanted, name); });
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

// The parts that have selected points. Their shapes are read, because what an element names in them must be there.
std::set<std::string> selected_parts(const ElementContext& context, const ShapeSelection& selection) {
  const ObjectTree& tree = context.scene.objects();
  std::set<std::string> parts;
  for (const auto& [point, object] : selection.points) {
    const std::uint32_t part = tree[*tree.find(point)].part;
    if (part != kNoObject) parts.insert(tree[part].name);
  }
  const std::string element = "element " + in_quotes(context.command.require("name").value);
  for (const std::string& part : parts) context.scene.read_shapes_of(part, element);
  return parts;
}

// The shapes that the attribute names. Leaves only points that have such shapes.
SelectedNames selected_names(const ElementContext& context, ShapeSelection& selection, std::string_view kind) {
  if (!context.attributes.is_set("shapes")) return {};
  selected_parts(context, selection);
  Flattener flattener(context.scene.root());
  flattener.update();
  SelectedNames known;
  std::map<std::string, SelectedNames, std::less<>> points_of_name;
  for (const ItemSource& source : flattener.item_sources()) {
    if (source.point == nullptr || !selection.points.contains(source.point->name)) continue;
    for (const ShapeName& each : flattener.names_of(source)) {
      known.emplace(each.name);
      points_of_name[std::string(each.name)].insert(source.point->name);
    }
  }
  SelectedNames names = matching_names(context, "shapes", known, kind, "shape");
  SelectedNames points;
  for (const std::string& name : names) points.insert(points_of_name[name].begin(), points_of_name[name].end());
  std::erase_if(selection.points, [&](const auto& point) { return !points.contains(point.first); });
  return names;
}

// The materials of the points' files and shapes that the attribute names.
SelectedNames selected_materials(const ElementContext& context, const ShapeSelection& selection,
                                 std::string_view kind) {
  if (!context.attributes.is_set("material")) return {};
  SelectedNames known;
  for (const std::string& part : selected_parts(context, selection)) {
    for (const NodePtr& node : nodes_of(context.scene.content_of(part).root)) {
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

AttributeTable with_selection_rows(AttributeTable own) {
  return join_tables({{std::begin(kSelectionRows), std::end(kSelectionRows)}, {own.begin(), own.end()}});
}

ShapeSelection selected_shapes(const ElementContext& context, std::string_view kind, SelectionLevel level) {
  ShapeSelection selection{.points = selected_points(context, kind, level),
                           .by_shape = level == SelectionLevel::shape,
                           .names = {},
                           .materials = {}};
  selection.names = selected_names(context, selection, kind);
  selection.materials = selected_materials(context, selection, kind);
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
  const auto point = std::ranges::find_if(a.points, [&](const auto& each) { return b.points.contains(each.first); });
  if (point == a.points.end()) return {};
  return SharedShapes{.point = point->first, .name = *name, .material = *material};
}

}  // namespace simvis
