#include "program/live/view_snapshot.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <set>
#include <utility>

#include <simvis/command.h>
#include <simvis/diagnostics.h>
#include "engine/draw/sky_sphere.h"
#include "program/report/explain.h"
#include "program/report/run_inputs.h"
#include "program/report/scene_list.h"
#include "simvis/built_scene.h"

namespace simvis::live {
namespace {

/// The scanners that elements of type laser_beams name.
std::set<std::string> drawn_scanners(const Parameters& parameters) {
  std::set<std::string> elements, scanners;
  for (const ElementDescriptor& element : parameters.elements()) {
    if (!element.removed && element.type == "laser_beams") elements.insert(element.name);
  }
  for (const std::string& change : parameters.changes()) {
    if (change.find("laser_beams") == std::string::npos) continue;
    for (const Command& command : parse_commands(change, "change log", "")) {
      const CommandAttribute *name = command.find("name"), *scanner = command.find("scanner");
      if (name != nullptr && scanner != nullptr && elements.contains(name->value)) scanners.insert(scanner->value);
    }
  }
  return scanners;
}

std::vector<ViewSensor> sensors_of(const BuiltScene& built) {
  std::vector<ViewSensor> sensors;
  const std::set<std::string> scanners = drawn_scanners(built.parameters);
  for (const BuiltSensor& sensor : built.sensors) {
    ViewSensor& view = sensors.emplace_back();
    view.name = sensor.name;
    view.type = sensor.type;
    view.insert_at = sensor.command.require("insert_at").value;
    for (const NamedTexts& texts : {given_attributes(sensor.command), default_attributes(sensor.command)}) {
      view.attributes.insert(view.attributes.end(), texts.begin(), texts.end());
    }
    view.outputs = sensor.outputs;
    view.visualization = sensor.sensor->visualization();
    view.beams = scanners.contains(sensor.name);
  }
  return sensors;
}

std::vector<ViewParameter> parameters_of(const Parameters& parameters) {
  std::vector<ViewParameter> views;
  for (const ElementDescriptor& element : parameters.elements()) {
    for (std::size_t i = 0; i < element.parameters.size(); ++i) {
      const AttributeSpec& spec = element.parameters[i];
      views.push_back({.element = element.name,
                       .type = element.type,
                       .insert_at = element.insertion_point,
                       .name = std::string(spec.name),
                       .unit = std::string(spec.unit),
                       .summary = std::string(spec.text),
                       .min = spec.min,
                       .max = spec.max,
                       .value = parameters.values()[element.first_value + i],
                       .full_turn = spec.full_turn,
                       .removed = element.removed});
    }
  }
  return views;
}

void take_table(std::uint32_t sensor, const Measurement& measurement, ViewFrame& frame) {
  MeasuredTable measured = measured_table(measurement);
  if (measured.columns.empty()) return;
  ViewTable& table = frame.tables.emplace_back(ViewTable{std::move(measured), sensor, true});
  for (const MeasuredArray& each : measurement.arrays) table.one_row &= each.kind != OutputKind::table_column;
}

std::string plan_text(const Diagnostics& diagnostics, bool times) {
  if (!times) return explain(diagnostics.frame_plan(), {diagnostics.counters(), diagnostics.planned_sensors()});
  return explain(diagnostics.frame_plan(), {diagnostics.counters(), diagnostics.planned_sensors(),
                                            diagnostics.frame_costs(), diagnostics.sensor_costs()});
}

bool is_wanted(const ViewWants& wants, const std::string& sensor) {
  return wants.every_sensor || wants.sensors.contains(sensor);
}

using MeasuredTimes = std::map<std::string, std::int64_t, std::less<>>;

void take_measurements(const MeasuredTimes& measured, Simulation& simulation, const ViewWants& wants,
                       ViewFrame& frame) {
  const BuiltScene& built = built_scene(simulation);
  for (std::uint32_t i = 0; i < built.sensors.size(); ++i) {
    const BuiltSensor& sensor = built.sensors[i];
    if (!is_wanted(wants, sensor.name)) continue;
    const auto when = measured.find(sensor.name);
    if (when == measured.end()) continue;
    add_measurement(i, simulation.measurement(sensor.name), frame);
  }
}

std::vector<std::uint32_t> hidden_items(const DrawList& list) {
  std::vector<std::uint32_t> hidden;
  for (std::uint32_t item = 0; item < list.items.size(); ++item) {
    if (!list.items[item].visible) hidden.push_back(item);
  }
  return hidden;
}

// Whether nothing but positions and normals is another, as in the frames of an animation.
bool differ_in_shape_only(const std::shared_ptr<const Mesh>& a, const std::shared_ptr<const Mesh>& b) {
  return a == b ||
         (a->topology == b->topology && a->positions.size() == b->positions.size() &&
          std::ranges::equal(a->attributes, b->attributes,
                             [](const VertexAttributes& one, const VertexAttributes& other) {
                               return one.uv[0] == other.uv[0] && one.uv[1] == other.uv[1] && one.color == other.color;
                             }) &&
          a->indices == b->indices);
}

}  // namespace

void add_measurement(std::uint32_t sensor, const Measurement& measurement, ViewFrame& frame) {
  if (std::optional<Scan> scan = to_scan(measurement)) {
    frame.scans.push_back({sensor, *std::move(scan)});
    return;
  }
  for (const MeasuredArray& each : measurement.arrays) {
    if (each.kind != OutputKind::image || each.count() == 0) continue;
    frame.images.push_back({sensor, measurement.time_ns, each});
  }
  take_table(sensor, measurement, frame);
}

// Hiding or deforming an item makes no new scene: pages would reload everything.
bool ViewCopier::is_new_scene(const DrawList& list, std::size_t changes) {
  if (std::exchange(restarted_, false) || scene_ == nullptr || changes != changes_) return true;
  if (list.revisions.structure == revisions_.structure) return false;
  const DrawList& known = scene_->list;
  const auto same_item = [](DrawItem a, const DrawItem& b) {
    a.visible = b.visible;
    return a == b;
  };
  return !std::ranges::equal(list.meshes, known.meshes, differ_in_shape_only) ||
         list.world_from_node.size() != known.world_from_node.size() ||
         list.materials.size() != known.materials.size() || !std::ranges::equal(list.items, known.items, same_item);
}

void ViewCopier::follow_scene(const Simulation& simulation) {
  const DrawList& list = simulation.diagnostics().draw_list();
  const std::size_t changes = simulation.parameters().changes().size();
  const bool is_new = is_new_scene(list, changes);
  if (is_new || list.revisions.structure != revisions_.structure) {
    std::vector<std::uint32_t> hidden = hidden_items(list);
    if (is_new || hidden != *hidden_) hidden_ = std::make_shared<const std::vector<std::uint32_t>>(std::move(hidden));
  }
  if (is_new) {
    const BuiltScene& built = built_scene(simulation);
    auto scene = std::make_shared<ViewScene>();
    scene->name = std::filesystem::path(built.name).stem().string();
    scene->structure = scene_ == nullptr ? 1 : scene_->structure + 1;
    scene->items = simulation.items();  // which reads shapes that no sensor needs
    scene->list = list;
    for (DrawItem& item : scene->list.items) item.visible = true;
    scene->objects = simulation.objects();
    scene->transforms = named_transforms(built);
    scene->list_json = to_json(list_scene(built));
    scene->sensors = sensors_of(built);
    scene->parameters = parameters_of(built.parameters);
    if (const auto physics = find_physics(built.scene)) scene->bodies = physics->drawn_bodies();
    scene_ = std::move(scene);
    changes_ = changes;
  }
  const auto follow = [&](auto& mine, const auto& theirs, std::uint64_t now, std::uint64_t before) {
    if (is_new || now != before) mine = std::make_shared<std::remove_cvref_t<decltype(theirs)>>(theirs);
  };
  follow(world_from_node_, list.world_from_node, list.revisions.transforms, revisions_.transforms);
  follow(materials_, list.materials, list.revisions.materials, revisions_.materials);
  follow(meshes_, list.meshes, list.revisions.structure, revisions_.structure);
  follow(lights_, list.lights, list.revisions.lights, revisions_.lights);
  revisions_ = list.revisions;
}

void ViewCopier::skip(const Simulation& simulation, const FrameTime& time) {
  for (const std::string& sensor : simulation.measured()) measured_ns_.insert_or_assign(sensor, time.time_ns);
}

ViewFrame ViewCopier::copy(Simulation& simulation, const FrameTime& time, double step_ms, const ViewWants& wants) {
  follow_scene(simulation);
  ViewFrame frame;
  frame.index = time.index;
  frame.time_ns = time.time_ns;
  frame.step_ms = wants.times ? step_ms : std::numeric_limits<double>::quiet_NaN();
  frame.scene = scene_;
  frame.world_from_node = world_from_node_;
  frame.materials = materials_;
  frame.meshes = meshes_;
  frame.lights = lights_;
  frame.hidden = hidden_;
  const DrawList& list = simulation.diagnostics().draw_list();
  frame.environment = {.ambient = list.environment.ambient, .background = glm::vec3(mean_background(list))};
  const std::span<const double> values = simulation.parameters().values();
  frame.values.assign(values.begin(), values.end());
  frame.warnings = simulation.warnings();
  skip(simulation, time);
  take_measurements(measured_ns_, simulation, wants, frame);
  std::erase_if(measured_ns_, [&](const auto& each) { return is_wanted(wants, each.first); });
  if (wants.physics && !scene_->bodies.empty())
    frame.physics = find_physics(built_scene(simulation).scene)->drawn_state();
  if (wants.plan) frame.plan = plan_text(simulation.diagnostics(), wants.times);
  return frame;
}

}  // namespace simvis::live
