#include "program/report/scene_list.h"

#include <algorithm>
#include <map>
#include <string_view>

#include "scenegraph/graph_walk.h"
#include "simvis/mount_frame.h"

namespace simvis {
namespace {

// Collects what stands where in one walk through the graph.
class SceneLister {
 public:
  explicit SceneLister(const BuiltScene& built) : built_(built) {
    for (const Object& object : built.scene.objects().all()) {
      if (object.kind == ObjectKind::part) parts_[built.scene.find_node(object.name).get()] = object.name;
    }
    for (const ElementDescriptor& element : built.parameters.elements()) {
      if (!element.removed) add_element(element);
    }
    for (const BuiltSensor& sensor : built.sensors) add_sensor(sensor);
  }

  SceneList take() {
    list_.parts.push_back({.name = built_.scene.root()->name, .insert_at = "", .source = "frame"});
    open_parts_ = {0};
    walk_graph(*built_.scene.root(), {.visit = [this](const Node& node, const WalkState& state) { visit(node, state); },
                                      .leave = [this](const Group& group) { leave(group); }});
    for (std::size_t i = 0; i < list_.elements.size(); ++i) at(list_.elements[i].insert_at).elements.push_back(i);
    for (std::size_t i = 0; i < list_.sensors.size(); ++i) at(list_.sensors[i].insert_at).sensors.push_back(i);
    list_.warnings = built_.scene.warnings();
    return std::move(list_);
  }

 private:
  void add_element(const ElementDescriptor& element) {
    ListedElement listed{.name = element.name,
                         .type = element.type,
                         .insert_at = element.insertion_point,
                         .parameters = {},
                         .shapes = {}};
    for (std::size_t i = 0; i < element.parameters.size(); ++i) {
      listed.parameters.push_back({element.parameters[i], built_.parameters.values()[element.first_value + i]});
    }
    // A part may have the same name, and is then what find_node() finds.
    const NodePtr node = built_.scene.find_node(element.name);
    if (node != nullptr && !parts_.contains(node.get())) elements_[node.get()] = list_.elements.size();
    list_.elements.push_back(std::move(listed));
  }

  void add_sensor(const BuiltSensor& sensor) {
    ListedSensor listed{.name = sensor.name,
                        .type = sensor.type,
                        .insert_at = sensor.command.require("insert_at").value,
                        .method = sensor.sensor->method(),
                        .attributes = {},
                        .outputs = sensor.outputs,
                        .world_from_sensor = {}};
    for (const CommandAttribute& attribute : sensor.command.attributes) {
      if (std::ranges::count(kSensorCommonAttributes, attribute.name) > 0) continue;
      listed.attributes.emplace_back(attribute.name, attribute.value);
    }
    mounts_[sensor.mount.get()] = list_.sensors.size();
    list_.sensors.push_back(std::move(listed));
  }

  void visit(const Node& node, const WalkState& state) {
    if (const auto part = parts_.find(&node); part != parts_.end()) open_part(part->second);
    if (const auto element = elements_.find(&node); element != elements_.end() && is_group(node)) {
      open_elements_.push_back({&node, element->second});
    }
    if (node.kind() == NodeKind::insertion_point) {
      points_.emplace(node.name, open_parts_.back());
      if (node.name != list_.parts[open_parts_.back()].name) {
        list_.parts[open_parts_.back()].insertion_points.push_back(node.name);
      }
    } else if (node.kind() == NodeKind::shape && state.visible) {
      add_shape(*static_cast<const Shape&>(node).mesh(), state);
    } else if (const auto mount = mounts_.find(&node); mount != mounts_.end()) {
      glm::dmat4 world_from_sensor;
      if (rigid_mount_frame(state.world_from_node, world_from_sensor)) {
        list_.sensors[mount->second].world_from_sensor = world_from_sensor;
      }
    }
  }

  void open_part(std::string_view name) {
    const Command& command = built_.scene.part_command(name);
    const CommandAttribute* const file = command.find("file");
    const CommandAttribute* const shape = command.find("shape");
    open_parts_.push_back(list_.parts.size());
    list_.parts.push_back({.name = std::string(name),
                           .insert_at = command.require("insert_at").value,
                           .source = file != nullptr    ? file->value
                                     : shape != nullptr ? shape->value
                                                        : "frame",
                           .depth = open_parts_.size() - 1});
  }

  void leave(const Group& group) {
    if (parts_.contains(&group)) open_parts_.pop_back();
    if (!open_elements_.empty() && open_elements_.back().first == &group) open_elements_.pop_back();
  }

  void add_shape(const Mesh& mesh, const WalkState& state) {
    if (mesh.indices.empty()) return;
    ListedShapes& shapes = open_elements_.empty() ? list_.parts[open_parts_.back()].shapes
                                                  : list_.elements[open_elements_.back().second].shapes;
    if (mesh.topology == Topology::triangles) shapes.triangles += mesh.indices.size() / 3;
    for (const std::uint32_t index : mesh.indices) {
      const glm::dvec3 point(state.world_from_node * glm::dvec4(glm::dvec3(mesh.positions[index]), 1));
      shapes.box_min_m = shapes.any ? glm::min(shapes.box_min_m, point) : point;
      shapes.box_max_m = shapes.any ? glm::max(shapes.box_max_m, point) : point;
      shapes.any = true;
    }
    if (state.material == nullptr) return;
    const Material* const material = state.material->shown().get();
    if (std::ranges::find(shapes.materials, material) == shapes.materials.end()) shapes.materials.push_back(material);
  }

  static bool is_group(const Node& node) { return dynamic_cast<const Group*>(&node) != nullptr; }

  // What is inserted below a switch that is off stands at ROOT: its place was not reached.
  ListedPart& at(const std::string& point) {
    const auto found = points_.find(point);
    return list_.parts[found == points_.end() ? 0 : found->second];
  }

  const BuiltScene& built_;
  SceneList list_;
  std::map<const Node*, std::string_view> parts_;         // separators
  std::map<const Node*, std::size_t> elements_, mounts_;  // numbers in list_
  std::map<std::string, std::size_t> points_;             // numbers of parts
  std::vector<std::size_t> open_parts_;
  std::vector<std::pair<const Node*, std::size_t>> open_elements_;
};

}  // namespace

SceneList list_scene(const BuiltScene& built) { return SceneLister(built).take(); }

}  // namespace simvis
