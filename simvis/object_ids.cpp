#include "simvis/object_ids.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>
#include <utility>

#include "elements/label.h"
#include "engine/base/fnv1a.h"
#include "simvis/selected_items.h"

namespace simvis {
namespace {

// Stands between the parts of a key. No name of a command has a line end.
constexpr const char* kBetween = "\n";

std::uint32_t hash_of(const NameIds::Key& key) {
  const std::uint64_t hash = fnv1a_step(fnv1a(key.first), key.second);
  return static_cast<std::uint32_t>(hash ^ hash >> 32);
}

bool is_endless(const Mesh& mesh) {
  return !std::isfinite(mesh.bounds_min.x) || !std::isfinite(mesh.bounds_max.x) ||
         (mesh.surface && mesh.surface->kind == SurfaceKind::plane && std::isinf(mesh.surface->half_size_m.x));
}

// Whether each axis of the mesh leads along an axis of the frame, so that the box of the mesh's box is that of the
// mesh.
bool keeps_boxes(const glm::dmat4& frame_from_mesh) {
  for (int column = 0; column < 3; ++column) {
    int others = 0;
    for (int row = 0; row < 3; ++row) others += frame_from_mesh[column][row] != 0 ? 1 : 0;
    if (others > 1) return false;
  }
  return true;
}

void extend(glm::dvec3& low_m, glm::dvec3& high_m, const glm::dvec3& at_m) {
  low_m = glm::min(low_m, at_m);
  high_m = glm::max(high_m, at_m);
}

// The box of a mesh in another frame.
std::pair<glm::dvec3, glm::dvec3> box_in(const Mesh& mesh, const glm::dmat4& frame_from_mesh) {
  glm::dvec3 low_m(std::numeric_limits<double>::infinity()), high_m(-low_m);
  const auto add = [&](const glm::dvec3& at_m) {
    extend(low_m, high_m, glm::dvec3(frame_from_mesh * glm::dvec4(at_m, 1)));
  };
  if (keeps_boxes(frame_from_mesh)) {
    add(mesh.bounds_min);
    add(mesh.bounds_max);
  } else {
    for (const glm::vec3& position : mesh.positions) add(position);
  }
  return {low_m, high_m};
}

}  // namespace

std::vector<std::uint32_t> NameIds::ids_of(std::span<const Key> keys) {
  std::set<Key> unknown;
  for (const Key& key : keys) {
    if (!id_of_.contains(key)) unknown.insert(key);
  }
  for (const Key& key : unknown) {
    std::uint32_t id = hash_of(key);
    while (id == 0 || !taken_.insert(id).second) ++id;
    id_of_.emplace(key, id);
  }
  std::vector<std::uint32_t> ids;
  for (const Key& key : keys) ids.push_back(id_of_.at(key));
  return ids;
}

void ObjectIds::update(const Scene& scene, const Flattener& flattener) {
  if (rebuilds_ == flattener.counters().rebuilds) return;
  rebuilds_ = flattener.counters().rebuilds;
  name_shapes(flattener);
  name_objects(scene, flattener);
}

void ObjectIds::name_shapes(const Flattener& flattener) {
  std::unordered_map<const InsertionPoint*, std::uint32_t> count;
  std::vector<NameIds::Key> keys;
  for (const ItemSource& source : flattener.item_sources()) {
    keys.emplace_back(source.point == nullptr ? "" : source.point->name, count[source.point]++);
  }
  shapes_ = shape_ids_.ids_of(keys);
}

// Finds the object of each item of a flattener.
class ObjectIds::Naming {
 public:
  Naming(const Scene& scene, const Flattener& flattener) : tree_(scene.objects()), flattener_(flattener) {
    for (std::uint32_t i = 1; i < tree_.size(); ++i) {
      const Object& object = tree_[i];
      objects.push_back({.parent = object.parent, .name = object.name, .path = object.path, .kind = object.kind});
      keys.emplace_back(object.name, 0);
      frames.push_back(object.name);
    }
  }

  /// The number of the object of an item, which `label` labels if it is not null.
  std::size_t object_of(const ItemSource& source, std::uint32_t item, const SelectedItem& selected,
                        const Label* label) {
    const std::string point = source.point == nullptr ? tree_[0].name : source.point->name;
    if (label == nullptr) return object_named(point);
    const ShapeSelection& selection = label->shapes;
    const std::string& around = selection.points.find(point)->second;
    if (selection.by_shape) return shapes_object(source, item, selected.name, point);
    if (selection.materials.empty() && selection.names.empty()) return object_named(around);
    return object_within(around, label->element, around + kBetween + kBetween + label->element);
  }

  std::vector<SceneObject> objects;  // `parent` is the parent's number in the tree
  std::vector<NameIds::Key> keys;    // of the ids
  std::vector<std::string> frames;   // names of the insertion points

 private:
  std::size_t object_named(const std::string& name) {
    if (const std::optional<std::uint32_t> found = tree_.find(name); found && *found > 0) return *found - 1;
    const auto [world, is_new] = within_.try_emplace(name, objects.size());
    if (is_new) add({.parent = 0, .name = name, .path = name, .kind = ObjectKind::world}, name, name);
    return world->second;
  }

  // What a name of the file has, with all its surfaces; without a name, one surface.
  std::size_t shapes_object(const ItemSource& source, std::uint32_t item, const ShapeName& name,
                            const std::string& point) {
    const std::uint32_t number = count_[point]++;
    if (name.name.empty()) {
      const std::string& own = source.shape->name.empty() ? source.shape->mesh()->name : source.shape->name;
      return object_within(point, own.empty() ? std::to_string(number) : own,
                           point + kBetween + std::to_string(number));
    }
    const bool is_own = name.group == 0;  // then shapes of one node that have the name belong together
    const std::uint32_t transform = is_own ? flattener_.item_transform(item) : 0;
    const auto occurrence = std::tuple(point, std::string(name.name), is_own ? source.group : name.group, transform);
    const auto [found, is_new] = ranks_.try_emplace(occurrence, 0);
    if (is_new) found->second = next_rank_[{point, std::string(name.name)}]++;
    return object_within(point, std::string(name.name),
                         point + kBetween + std::string(name.name) + kBetween + std::to_string(found->second));
  }

  std::size_t object_within(const std::string& around, const std::string& own, const std::string& key) {
    const auto [found, is_new] = within_.try_emplace(key, objects.size());
    if (!is_new) return found->second;
    const std::uint32_t parent = *tree_.find(around);
    std::string path = tree_[parent].path + "/" + own;
    if (const std::uint32_t before = same_path_[path]++; before > 0) path += ":" + std::to_string(before + 1);
    add({.parent = parent, .name = path, .path = path, .kind = ObjectKind::shape}, key, around);
    return found->second;
  }

  void add(SceneObject object, const std::string& key, const std::string& frame) {
    objects.push_back(std::move(object));
    keys.emplace_back(key, 0);
    frames.push_back(frame);
  }

  const ObjectTree& tree_;
  const Flattener& flattener_;
  std::unordered_map<std::string, std::size_t> within_;   // objects that are not in the tree, by key
  std::unordered_map<std::string, std::uint32_t> count_,  // of single surfaces, by point
      same_path_;                                         // of objects in within_
  std::map<std::tuple<std::string, std::string, std::uint32_t, std::uint32_t>, std::uint32_t> ranks_;
  std::map<std::pair<std::string, std::string>, std::uint32_t> next_rank_;  // by point and name
};

void ObjectIds::name_objects(const Scene& scene, const Flattener& flattener) {
  class_names_.clear();
  const std::vector<const Label*> labels = labels_of(scene);
  std::vector<const ShapeSelection*> selections;
  for (const Label* const label : labels) {
    class_names_[label->class_id] = label->class_name;
    selections.push_back(&label->shapes);
  }
  Naming naming(scene, flattener);
  const std::vector<SelectedItem> selected = selections_of_items(selections, flattener);
  std::vector<std::size_t> object_of;
  classes_.clear();
  for (std::uint32_t item = 0; item < selected.size(); ++item) {
    const std::uint32_t selection = selected[item].selection;
    const Label* const label = selection == 0 ? nullptr : labels[selection - 1];
    classes_.push_back(label == nullptr ? 0 : label->class_id);
    object_of.push_back(naming.object_of(flattener.item_sources()[item], item, selected[item], label));
    SceneObject& object = naming.objects[object_of.back()];
    object.surfaces.push_back({.item = item});
    if (label == nullptr) continue;
    object.semantic = label->class_id;
    object.label = label->class_name;
  }
  const std::vector<std::uint32_t> ids = object_ids_.ids_of(naming.keys);
  instances_.clear();
  for (const std::size_t object : object_of) instances_.push_back(ids[object]);
  objects_ = std::move(naming.objects);
  frames_.clear();
  boxes_.clear();
  id_of_name_.clear();
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    SceneObject& object = objects_[i];
    object.instance = ids[i];
    id_of_name_.emplace(object.name, ids[i]);
    object.parent = object.parent == 0 ? 0 : ids[object.parent - 1];
    if (object.surfaces.empty()) continue;
    object.transform = flattener.item_transform(object.surfaces.front().item);
    const bool is_one = std::ranges::all_of(object.surfaces, [&](const ObjectSurface& each) {
      return flattener.item_transform(each.item) == object.transform;
    });
    if (is_one) continue;
    frames_.push_back({i, &scene.point_node(naming.frames[i])});
    object.transform = flattener.transform_of(*frames_.back().point).value_or(0);
  }
}

std::uint32_t ObjectIds::id_of(std::string_view name) const {
  const auto found = id_of_name_.find(name);
  return found == id_of_name_.end() ? 0 : found->second;
}

std::span<const SceneObject> ObjectIds::objects(const Flattener& flattener, const DrawList& list) {
  for (const PointFrame& frame : frames_) {
    SceneObject& object = objects_[frame.object];
    for (ObjectSurface& each : object.surfaces) {
      const std::uint32_t transform = list.items[each.item].transform;
      const std::optional<glm::dmat4> chain = flattener.between(object.transform, transform);
      each.frame_from_mesh =
          chain ? *chain : glm::inverse(list.world_from_node[object.transform]) * list.world_from_node[transform];
    }
  }
  for (SceneObject& object : objects_) {
    if (object.semantic != 0) measure(object, list);
  }
  return objects_;
}

// Surfaces in several nodes have their boxes by their vertices, which are looked at again only if they have changed.
void ObjectIds::measure(SceneObject& object, const DrawList& list) {
  constexpr double kEndless_m = std::numeric_limits<double>::infinity();
  object.low_m = glm::dvec3(kEndless_m);
  object.high_m = -object.low_m;
  for (const ObjectSurface& each : object.surfaces) {
    const Mesh& mesh = *list.meshes[list.items[each.item].mesh];
    if (is_endless(mesh)) {
      object.low_m = glm::dvec3(-kEndless_m);
      object.high_m = glm::dvec3(kEndless_m);
      return;
    }
    KnownBox& box = boxes_[each.item];
    if (box.mesh != &mesh || box.frame_from_mesh != each.frame_from_mesh) {
      const auto [low_m, high_m] = box_in(mesh, each.frame_from_mesh);
      box = {.mesh = &mesh, .frame_from_mesh = each.frame_from_mesh, .low_m = low_m, .high_m = high_m};
    }
    object.low_m = glm::min(object.low_m, box.low_m);
    object.high_m = glm::max(object.high_m, box.high_m);
  }
}

const std::string& ObjectIds::class_name(std::uint32_t item) const {
  static const std::string kNone;
  const auto found = class_names_.find(classes_[item]);
  return found == class_names_.end() ? kNone : found->second;
}

}  // namespace simvis
