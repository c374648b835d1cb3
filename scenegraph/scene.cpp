#include <simvis/scene.h>

#include <algorithm>
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
#include "scenegraph/graph_walk.h"
#include "scenegraph/language/command_attributes.h"
#include "scenegraph/language/other_kinds.h"
#include "scenegraph/language/row_names.h"
#include "scenegraph/name_set.h"
#include "scenegraph/part_objects.h"
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

void set_opacity(const NodePtr& root, double opacity) {
  for (const NodePtr& node : nodes_of(root)) {
    if (node->kind() != NodeKind::material) continue;
    auto& material = static_cast<MaterialNode&>(*node);
    material.set_change(material.add_change(), {.fixed_opacity = static_cast<float>(opacity)});
  }
}

// "world.glb: no buffers" -> "world.glb: error: no buffers".
std::string with_error_word(std::string warning) {
  const std::size_t at = warning.find(": ");
  return at == std::string::npos ? warning : warning.insert(at, ": error");
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

void rethrow_from_part(const Command& part, const InputError& error) {
  fail_at(part.where, "part " + part.require("name").value + ": " + without_error_word(error.what()));
}

Scene::Scene() : root_(std::make_shared<Group>()), part_names_(std::make_unique<NameSet>("part")) {
  root_->name = "ROOT";
  const auto point = std::make_shared<InsertionPoint>();
  point->name = root_->name;
  root_->add(point);
  places_[root_->name] = {root_.get(), point.get()};
  part_names_->reserve(root_->name);
}

Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;
Scene::~Scene() = default;

AttributeTable Scene::part_attributes() { return kPartAttributes; }

const PartContent& Scene::insert_part(const Command& command, const std::string& prefix) {
  const CommandAttribute& name = command.require("name");
  const std::optional<glm::dmat4> offset = pose_offset(command);
  const Place at = place(command);
  Content& shared = load_content(command);
  const PartContent& content = shared.part;

  Part part{.command = command,
            .separator = std::make_shared<Separator>(),
            .content = &shared,
            .root = content.root,
            .clone_of = {},
            .insert_at = at.point->name,
            .number = next_part_++};
  part.separator->name = name.value;
  const auto point = std::make_shared<InsertionPoint>(ObjectKind::part);
  point->name = name.value;
  if (offset) part.separator->add(std::make_shared<Transform>(*offset));
  part.separator->add(point);
  if (!content.points.empty()) part.root = clone_graph(content.root, part.clone_of);
  part.separator->add(part.root);
  add_place(name, {part.separator.get(), point.get()});
  add_points(name, part, prefix);
  insert_at(at, part.separator);
  if (!objects_are_stale_) add_objects(part, objects_);
  parts_[name.value] = std::move(part);
  const auto taken = std::make_shared<decltype(parts_)::node_type>();
  undo_.add(
      [this, key = name.value, taken] {
        *taken = parts_.extract(key);
        objects_are_stale_ = true;
      },
      [this, taken] {
        parts_.insert(std::move(*taken));
        objects_are_stale_ = true;
      });
  const AttributeValues attributes(command, kPartAttributes, kPartCommonAttributes);
  if (attributes.is_set("opacity")) set_opacity(own_clone(parts_[name.value]), attributes.number("opacity"));
  return content;
}

void Scene::add_place(const CommandAttribute& name, const Place& place) {
  part_names_->claim(name);
  places_[name.value] = place;
  undo_.add(
      [this, key = name.value] {
        part_names_->release(key);
        places_.erase(key);
      },
      [this, name, place] {
        part_names_->claim(name);
        places_[name.value] = place;
      });
}

void Scene::add_points(const CommandAttribute& part_name, Part& part, const std::string& prefix) {
  if (part.clone_of.empty()) return;
  for (const PartObject& object : part_objects(part.root)) {
    object.point->name = prefix + object.point->name;
    add_place({"name", object.point->name, part_name.where}, {object.group, object.point});
    part.objects.push_back({object.point, object.parent});
  }
}

void Scene::add_objects(const Part& part, ObjectTree& tree) {
  std::vector<std::uint32_t> numbers{tree.add(part.separator->name, ObjectKind::part, *tree.find(part.insert_at))};
  for (const OwnObject& object : part.objects) {
    numbers.push_back(tree.add(object.point->name, object.point->object_kind, numbers[object.parent]));
  }
}

const ObjectTree& Scene::objects() const {
  if (!objects_are_stale_) return objects_;
  objects_ = ObjectTree();
  for (const Part* const part : parts_in_order()) add_objects(*part, objects_);
  objects_are_stale_ = false;
  return objects_;
}

std::uint32_t Scene::find_object(std::string_view noun, std::string_view name, const Location& where) const {
  if (const std::optional<std::uint32_t> found = objects().find(name)) return *found;
  fail_at(where, objects().unknown(noun, name));
}

std::vector<std::uint32_t> Scene::find_objects(std::string_view value, const Location& where) const {
  std::vector<std::string> unknown;
  std::vector<std::uint32_t> found = objects().named(value, unknown);
  if (!unknown.empty()) fail_at(where, objects().unknown("part or link", unknown.front()));
  return found;
}

void Scene::insert_at(const Place& place, const NodePtr& node) {
  place.parent->insert_before(*place.point, node);
  note_child(place.parent, node);
}

// The steps that take a new child out and put it back where it stood.
void Scene::note_child(Group* parent, const NodePtr& node) {
  const auto next = std::make_shared<NodePtr>();
  undo_.add(
      [parent, node, next] {
        const auto after = std::ranges::find(parent->children(), node) + 1;
        *next = after == parent->children().end() ? nullptr : *after;
        parent->remove(*node);
      },
      [parent, node, next] {
        if (*next == nullptr) {
          parent->add(node);
        } else {
          parent->insert_before(**next, node);
        }
        next->reset();
      });
}

void Scene::insert(const Command& command, NodePtr node) {
  insert_at(place(command), node);
  remember(command, node);
}

void Scene::remember(const Command& command, const NodePtr& node) {
  if (command.kind != CommandKind::element) return;
  const std::string& name = command.require("name").value;
  if (!nodes_.emplace(name, node).second) return;
  undo_.add([this, name] { nodes_.erase(name); }, [this, name, node] { nodes_.emplace(name, node); });
}

void Scene::insert_in_world(NodePtr node) {
  root_->insert_before(*root_->children().front(), node);
  note_child(root_.get(), node);
}

void Scene::insert_in_world(const Command& command, NodePtr node) {
  place(command);  // throws if the place does not exist
  insert_in_world(node);
  remember(command, node);
}

void Scene::insert_behind_point(std::string_view point, NodePtr node) {
  SIMVIS_ASSERT(has_insertion_point(point));
  const Place& at = places_.find(point)->second;
  const auto next = std::ranges::find(at.parent->children(), at.point, &NodePtr::get) + 1;
  if (next == at.parent->children().end()) {  // a link without content
    at.parent->add(node);
  } else {
    at.parent->insert_before(**next, node);
  }
  note_child(at.parent, node);
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

OwnPart Scene::own_part(std::string_view name, const Location& where) {
  const auto found = parts_.find(name);
  if (found == parts_.end()) {
    fail_at(where, objects().unknown("part", name) + " (expected the name of a part inserted before)");
  }
  Part& part = found->second;
  read_shapes_of(part, to_string(where));
  own_clone(part);
  return {part.root, part.content->part, part.clone_of};
}

const NodePtr& Scene::own_clone(Part& part) {
  if (part.clone_of.empty()) {
    const NodePtr shared = part.root;
    part.root = clone_graph(part.content->part.root, part.clone_of);
    part.separator->remove(*shared);
    part.separator->add(part.root);
  }
  return part.root;
}

const PartContent& Scene::content_of(std::string_view name) const {
  const auto found = parts_.find(name);
  SIMVIS_ASSERT(found != parts_.end());
  return found->second.content->part;
}

NodePtr Scene::find_node(std::string_view name) const {
  if (const auto part = parts_.find(name); part != parts_.end()) return part->second.separator;
  const auto node = nodes_.find(name);
  return node == nodes_.end() ? nullptr : node->second;
}

const Command& Scene::part_command(std::string_view name) const {
  const auto part = parts_.find(name);
  SIMVIS_ASSERT(part != parts_.end());
  return part->second.command;
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

std::vector<const Scene::Part*> Scene::parts_in_order() const {
  std::vector<const Part*> parts;
  for (const auto& [name, part] : parts_) parts.push_back(&part);
  std::ranges::sort(parts, {}, &Part::number);
  return parts;
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
  const AttributeValues attributes(part.command, kPartAttributes, kPartCommonAttributes);
  if (attributes.is_set("opacity")) set_opacity(copy, attributes.number("opacity"));
}

bool Scene::has_insertion_point(std::string_view name) const { return places_.find(name) != places_.end(); }

const InsertionPoint& Scene::point_node(std::string_view name) const {
  const auto place = places_.find(name);
  SIMVIS_ASSERT(place != places_.end());
  return *place->second.point;
}

std::optional<glm::dmat4> Scene::world_from_point(std::string_view name) const {
  const auto place = places_.find(name);
  SIMVIS_ASSERT(place != places_.end());
  std::optional<glm::dmat4> found;
  walk_graph(*root_, {.visit = [&](const Node& node, const WalkState& state) {
    if (&node == place->second.point) found = state.world_from_node;
  }});
  return found;
}

const Scene::Place& Scene::place(const Command& command) const {
  const CommandAttribute& name = command.require("insert_at");
  const auto found = places_.find(name.value);
  if (found == places_.end()) {
    fail_at(name.where, objects().unknown("insertion point", name.value) +
                            " (expected ROOT or the name of a part inserted before)");
  }
  return found->second;
}

void Scene::warn(const std::string& warning) {
  if (strict_) throw InputError(with_error_word(warning) + " (a warning, which is an error here)");
  if (std::ranges::find(warnings_, warning) != warnings_.end()) return;
  warnings_.push_back(warning);
  undo_.add_for_roll_back([this] { warnings_.pop_back(); });
}

void Scene::warn(const Location& where, std::string_view what) { warn(to_string(where) + ": " + std::string(what)); }

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
