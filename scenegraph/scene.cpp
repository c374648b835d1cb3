#include <simvis/scene.h>

#include <algorithm>
#include <optional>

#include <simvis/part_importer.h>
#include "engine/base/assert.h"
#include "scenegraph/clone_graph.h"
#include "scenegraph/graph_walk.h"
#include "scenegraph/language/command_attributes.h"
#include "scenegraph/name_set.h"
#include "scenegraph/part_objects.h"

namespace simvis {
namespace {

// "world.glb: no buffers" -> "world.glb: error: no buffers".
std::string with_error_word(std::string warning) {
  const std::size_t at = warning.find(": ");
  return at == std::string::npos ? warning : warning.insert(at, ": error");
}

}  // namespace

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
        catch_up(parts_.insert(std::move(*taken)).position->second);
        objects_are_stale_ = true;
      });
  if (command.find("opacity") != nullptr) set_opacity(command, own_clone(parts_[name.value]));
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

std::vector<const Scene::Part*> Scene::parts_in_order() const {
  std::vector<const Part*> parts;
  for (const auto& [name, part] : parts_) parts.push_back(&part);
  std::ranges::sort(parts, {}, &Part::number);
  return parts;
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

}  // namespace simvis
