// What the parts of a scene hold: files and shapes, each read once, and what of them is read later.
#include <simvis/scene.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <unordered_set>

#include <simvis/attributes.h>
#include <simvis/part_importer.h>
#include "engine/base/assert.h"
#include "engine/base/folder_entries.h"
#include "engine/base/read_error.h"
#include "engine/base/read_fence.h"
#include "engine/base/read_scope.h"
#include "scenegraph/clone_graph.h"
#include "scenegraph/error_word.h"
#include "scenegraph/language/command_attributes.h"
#include "scenegraph/language/other_kinds.h"
#include "scenegraph/language/row_names.h"
#include "scenegraph/part_scale.h"
#include "scenegraph/point_shapes.h"
#include "scenegraph/postponed_shapes.h"
#include "scenegraph/same_graph.h"
#include "scenegraph/shape_part.h"
#include "scenegraph/wall_part.h"

namespace simvis {
namespace {

constexpr auto kPartCommonAttributes = names_of(kPartCommonRows);
constexpr AttributeSpec kPartAttributes[] = {
    {
        .name = "up",
        .kind = AttributeKind::choice,
        .text = "which axis of the file points up; the format's own if not given",
        .choices = "y z",
    },
    {.name = "opacity", .text = "opacity of all materials; the file's own if not given", .min = 0, .max = 1},
    {
        .name = "xacro_arguments",
        .kind = AttributeKind::text,
        .text = "arguments of a xacro file: NAME:=VALUE, separated by spaces; the file's own values if not given",
    },
    {
        .name = "missing_visuals",
        .kind = AttributeKind::choice,
        .default_value = "few",
        .text = "how many visuals of a robot's file may be missing: few is up to half",
        .choices = "few any",
    },
    kScaleRow,
    kUnitRow,
    kShapeRow,
    kSizeRow,
    kRadiusRow,
    kLengthRow,
    kColorRow,
    kTextureRow,
    kHeightsRow,
    kZRangeRow,
    kPointsRow,
    kHeightRow,
    kThicknessRow,
    kDoorsRow,
    kWindowsRow,
    kPointRadiusRow,
    kPointShapeRow,
    {
        .name = "wall_height",
        .default_value = "2.5",
        .unit = "m",
        .text = "height of the walls of a ROS map",
        .min = 1e-6,
        .max = 1e6,
    },
};

// ", did you mean ...?" by the names of the folder. Requests of others do not learn what a folder holds.
std::string similar_file(const std::filesystem::path& missing) {
  const std::optional<ReadScope> scope = read_scope();
  if (scope && scope->limit) return "";
  std::vector<std::string> stems;
  const std::filesystem::path folder = missing.parent_path().empty() ? "." : missing.parent_path();
  for (const std::filesystem::path& each : folder_entries(folder)) {
    if (each.extension() == missing.extension()) stems.push_back(each.stem().string());
  }
  const std::string stem =
      nearest_name(missing.stem().string(), std::vector<std::string_view>(stems.begin(), stems.end()));
  return stem.empty() ? "" : ", did you mean " + in_quotes(stem + missing.extension().string()) + "?";
}

std::filesystem::path find_part_file(const Command& command) {
  const CommandAttribute& file = command.require("file");
  const std::filesystem::path path = command.folder / file.value;
  if (!is_there(path)) {
    fail_at(file.where, "there is no part file " + in_quotes(path.string()) + similar_file(path));
  }
  if (!is_input_file(path)) {
    fail_at(file.where, in_quotes(path.string()) + " is not a file, expected a part file");
  }
  return path;
}

// Whose files the part may name: its own, those of the scene and of the packages that the user gave.
Folders folders_open_to(const Command& command, const ImportRequest& request) {
  Folders folders = folders_of_part(request.file);
  if (!is_shared_folder(command.folder)) folders.push_back(command.folder);
  for (const PackageFolder& package : request.packages) folders.push_back(package.folder);
  return folders;
}

PartImporter find_importer(const std::filesystem::path& path, const Location& where) {
  if (const PartImporter importer = find_part_importer(path)) return importer;
  std::string known;
  for (const std::string& ending : known_part_endings()) known += (known.empty() ? "" : ", ") + ending;
  fail_at(where, "part file " + in_quotes(path.string()) + " is of an unknown kind, expected one of: " + known +
                     converter_of(path));
}

std::vector<std::string> points_of(const NodePtr& root) {
  std::vector<std::string> points;
  for (const NodePtr& node : nodes_of(root)) {
    if (node->kind() == NodeKind::insertion_point) points.push_back(node->name);
  }
  return points;
}

bool holds_nothing(const PartContent& content) {
  if (!content.commands.empty() || !content.points.empty()) return false;
  return std::ranges::none_of(nodes_of(content.root), [](const NodePtr& node) {
    return node->kind() == NodeKind::shape || node->kind() == NodeKind::light || node->kind() == NodeKind::mount;
  });
}

// A part of a file. Parts with equal keys have the same content.
struct FilePart {
  PartImporter importer = nullptr;
  ImportRequest request{};
  std::filesystem::path canonical{};
  double scale = 1;
  std::optional<ExactSurface> shape_of_points{};
  std::string key{};
};

FilePart file_part(const Command& command, const AttributeValues& attributes,
                   const std::vector<PackageFolder>& packages) {
  FilePart part{.scale = part_scale(command, attributes)};
  part.request.packages = packages;
  const std::filesystem::path path = find_part_file(command);
  part.importer = find_importer(path, command.require("file").where);
  part.request.file = path;
  std::error_code error;
  part.canonical = std::filesystem::canonical(path, error);
  if (error) part.canonical = path;
  part.key = part.canonical.string();
  if (attributes.is_set("up")) {
    part.request.up_given = true;
    part.request.up = attributes.choice("up") == "y" ? UpAxis::y : UpAxis::z;
    part.key += "|" + attributes.choice("up");
  }
  if (part.scale != 1) part.key += "|" + format_number(part.scale);
  part.request.wall_height_m = attributes.number("wall_height");
  if (const CommandAttribute* const height = command.find("wall_height")) {
    const bool is_map = path.extension() == ".yaml" || path.extension() == ".yml";
    if (!is_map) fail_at(height->where, "attribute \"wall_height\": it is for ROS maps, expected a file .yaml");
    part.key += "|wall_height " + format_number(part.request.wall_height_m);
  }
  part.request.allow_missing_visuals = attributes.choice("missing_visuals") == "any";
  if (const CommandAttribute* const missing = command.find("missing_visuals")) {
    constexpr std::array kRobots = {"r.urdf", "r.xacro", "r.sdf", "r.xml", "r.usd"};
    const bool is_robot =
        std::ranges::any_of(kRobots, [&](const char* robot) { return part.importer == find_part_importer(robot); });
    if (!is_robot) {
      fail_at(
          missing->where,
          "attribute \"missing_visuals\": it is for robots, expected a file .urdf, .xacro, .sdf, .world, .xml or .usd");
    }
    part.key += "|missing " + missing->value;
  }
  part.shape_of_points = shape_of_points(command, attributes, part.scale);
  if (part.shape_of_points) {
    part.key += "|" + attributes.choice("point_shape") + " " + format_number(part.shape_of_points->radius_m);
  }
  if (attributes.is_set("xacro_arguments")) {
    part.request.xacro_arguments = attributes.text("xacro_arguments");
    part.key += "|" + part.request.xacro_arguments;
  }
  return part;
}

// Warns of a file that has nothing to show, and shows the points of the others as what the part says.
void complete_content(PartContent& content, const FilePart& part, ContentPool& pool) {
  const std::filesystem::path& path = part.request.file;
  if (holds_nothing(content)) content.warnings.push_back(path.string() + ": holds nothing to show");
  if (part.shape_of_points) make_points_solid(content, path, *part.shape_of_points, pool);
}

// A group that has all nodes.
GroupPtr group_of(const std::vector<ShapesOfGroup>& shapes) {
  const auto all = std::make_shared<Group>();
  for (const ShapesOfGroup& each : shapes) {
    for (const NodePtr& node : each.nodes) all->add(node);
  }
  return all;
}

// Makes the reader of postponed shapes do what complete_content() does, with the folders that are open now.
ShapeReader completing(const PartContent& content, const FilePart& part) {
  return [part, read = content.read_shapes, scope = *read_scope(), has_content = !holds_nothing(content)](
             ContentPool& pool, std::vector<std::string>& warnings) {
    const ReadFence fence(scope);
    std::vector<ShapesOfGroup> shapes = read(pool, warnings);
    PartContent shown;
    shown.root = group_of(shapes);
    if (has_content) shown.points = {part.canonical.string()};
    complete_content(shown, part, pool);
    std::ranges::move(shown.warnings, std::back_inserter(warnings));
    return shapes;
  };
}

PartContent import_part(const Command& command, const FilePart& part, ContentPool& pool) {
  const ReadFence fence(folders_open_to(command, part.request));
  PartContent content = part.importer(part.request, pool);
  content.file = part.canonical;
  content.root->name.clear();  // the file as a whole has the name of its part
  content.points = points_of(content.root);
  if (content.read_shapes) {
    content.read_shapes = completing(content, part);
  } else {
    complete_content(content, part, pool);
  }
  return content;
}

// The surface of a picture that is read later, with the folders that are open now.
PartContent postponed_heights(const Command& command) {
  return postponed_shapes([command, scope = read_scope()](ContentPool& pool) {
    std::optional<ReadFence> fence;
    if (scope) fence.emplace(*scope);
    return make_shape(command, AttributeValues(command, kPartAttributes, kPartCommonAttributes), pool);
  });
}

}  // namespace

AttributeTable Scene::part_attributes() { return kPartAttributes; }

void rethrow_from_part(const Command& part, const InputError& error) {
  fail_at(part.where, "part " + part.require("name").value + ": " + without_error_word(error.what()));
}

// Files with identical content share one graph. Files with animations do not, because animations refer to their own
// nodes.
void Scene::share_graph(PartContent& content) const {
  if (content.animations != nullptr || content.read_shapes) return;
  for (const auto& [key, known] : contents_) {
    if (!known.part.read_shapes && same_graph(known.part.root, content.root)) {
      content.root = known.part.root;
      return;
    }
  }
}

const PartContent& Scene::content_of(std::string_view name) const {
  const auto found = parts_.find(name);
  SIMVIS_ASSERT(found != parts_.end());
  return found->second.content->part;
}

void Scene::forget_unused_content() {
  std::unordered_set<const Content*> used;
  for (const auto& [name, part] : parts_) used.insert(part.content);
  std::erase_if(contents_, [&](const auto& entry) { return !used.contains(&entry.second); });
}

void Scene::read_pictures(const std::string& needed_by) {
  if (!pool_.has_postponed_pictures()) return;
  std::vector<std::string> found;
  const auto pictures = pool_.read_pictures(found);
  for (const std::string& warning : found) warn(warning);
  std::vector<NodePtr> nodes = nodes_of(root_);
  for (const auto& [key, content] : contents_) {
    const std::vector<NodePtr> own = nodes_of(content.part.root);
    nodes.insert(nodes.end(), own.begin(), own.end());
  }
  for (const NodePtr& node : nodes) {
    if (node->kind() != NodeKind::material) continue;
    auto& material = static_cast<MaterialNode&>(*node);
    if (auto complete = pool_.completed(*material.material(), pictures)) {
      material.complete_material(std::move(complete));
    }
  }
  pool_.forget_postponed_pictures();
  pictures_needed_by_ = needed_by;
}

bool Scene::has_postponed_shapes() const {
  return std::ranges::any_of(parts_, [](const auto& each) { return bool(each.second.content->part.read_shapes); });
}

std::vector<PartFile> Scene::part_files() const {
  std::vector<PartFile> files;
  std::unordered_set<const Content*> listed;
  for (const Part* const part : parts_in_order()) {
    const Content& content = *part->content;
    if (content.part.file.empty() || !listed.insert(&content).second) continue;
    files.push_back({content.part.file, content.shapes_needed_by});
  }
  return files;
}

void Scene::read_shapes(const std::string& needed_by) {
  if (!has_postponed_shapes()) return;
  const std::vector<const Part*> parts = parts_in_order();
  for (const Part* const part : parts) read_shapes_of(part->command.require("name").value, needed_by);
  // Those of an attempt that has failed are lost with it.
  for (const Part* const part : parts) {
    for (const std::string& warning : part->content->part.warnings) warn(warning);
  }
}

void Scene::read_shapes_of(std::string_view name, const std::string& needed_by) {
  if (const auto part = parts_.find(name); part != parts_.end()) read_shapes_of(part->second, needed_by);
}

void Scene::read_shapes_of(Part& part, const std::string& needed_by) {
  Content& content = *part.content;
  if (!content.part.read_shapes) return;
  try {
    std::vector<std::string> warnings;
    const std::vector<ShapesOfGroup> shapes = content.part.read_shapes(pool_, warnings);
    std::ranges::move(warnings, std::back_inserter(content.part.warnings));
    content.part.read_shapes = nullptr;
    content.shapes_needed_by = needed_by;
    for (const ShapesOfGroup& each : shapes) {
      for (const NodePtr& node : each.nodes) each.group->add(node);
    }
    for (auto& [name, other] : parts_) {
      if (other.content == &content && !other.clone_of.empty()) complete_clone(other, shapes);
    }
    content.late_shapes = shapes;
  } catch (const InputError& wrong) {
    if (content.part.file.empty()) throw;  // a shape, whose errors have their place
    rethrow_from_part(part.command, wrong);
  }
  for (const std::string& warning : content.part.warnings) warn(warning);
}

// Copies shapes that were read after the part's graph had been copied.
void Scene::complete_clone(Part& part, const std::vector<ShapesOfGroup>& shapes) {
  const GroupPtr all = group_of(shapes);
  const NodePtr copy = clone_graph(all, part.clone_of);
  part.clone_of.erase(all.get());
  for (const ShapesOfGroup& each : shapes) {
    auto& group = static_cast<Group&>(*part.clone_of.at(each.group.get()));
    for (const NodePtr& node : each.nodes) group.add(part.clone_of.at(node.get()));
  }
  set_opacity(part.command, copy);
}

// Completes a part that was taken out of the scene while the shapes of its file were read.
void Scene::catch_up(Part& part) {
  const auto is_missing = [&](const ShapesOfGroup& each) {
    return !each.nodes.empty() && !part.clone_of.contains(each.nodes.front().get());
  };
  const std::vector<ShapesOfGroup>& shapes = part.content->late_shapes;
  if (!part.clone_of.empty() && std::ranges::any_of(shapes, is_missing)) complete_clone(part, shapes);
}

// Gives the materials the opacity that the part says, if it says one.
void Scene::set_opacity(const Command& part, const NodePtr& root) {
  const AttributeValues attributes(part, kPartAttributes, kPartCommonAttributes);
  if (!attributes.is_set("opacity")) return;
  for (const NodePtr& node : nodes_of(root)) {
    if (node->kind() != NodeKind::material) continue;
    auto& material = static_cast<MaterialNode&>(*node);
    material.set_change(material.add_change(), {.fixed_opacity = static_cast<float>(attributes.number("opacity"))});
  }
}

const PartContent& Scene::load_part(const Command& command) { return load_content(command).part; }

Scene::Content& Scene::load_content(const Command& command) {
  const AttributeValues attributes(command, kPartAttributes, kPartCommonAttributes);
  check_shape_attributes(command, attributes);
  if (command.find("file") == nullptr) return load_shape(command, attributes);
  FilePart part = file_part(command, attributes, packages_);
  part.request.postpone_shapes = postpones_shapes_;
  try {
    auto known = contents_.find(part.key);
    if (known == contents_.end()) {
      PartContent content = import_part(command, part, pool_);
      share_graph(content);
      if (part.scale != 1) scale_content(content, part.scale);
      known = add_content(part.key, std::move(content));
    }
    for (const std::string& warning : known->second.part.warnings) warn(warning);
    return known->second;
  } catch (const InputError& wrong) {
    rethrow_from_part(command, wrong);
  }
}

std::map<std::string, Scene::Content>::iterator Scene::add_content(const std::string& key, PartContent content) {
  std::string needed_by;
  if (!content.read_shapes) needed_by = postpones_shapes_ ? "its format, which is read whole" : shapes_needed_by_;
  return contents_.emplace(key, Content{std::move(content), std::move(needed_by)}).first;
}

Scene::Content& Scene::load_shape(const Command& command, const AttributeValues& attributes) {
  const std::string key = shape_key(command, attributes);
  auto known = contents_.find(key);
  if (known == contents_.end()) {
    const bool is_postponed = postpones_shapes_ && attributes.is_set(kHeightsRow.name);
    PartContent content = is_postponed ? postponed_heights(command) : make_shape(command, attributes, pool_);
    share_graph(content);
    known = add_content(key, std::move(content));
  }
  for (const std::string& warning : known->second.part.warnings) warn(warning);
  return known->second;
}

}  // namespace simvis
