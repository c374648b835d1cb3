#include "simvis/simulation_impl.h"

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "engine/base/cache_file.h"
#include "simvis/mount_frame.h"

namespace simvis {

namespace {

// The device reports progress to the same callback as the simulation.
DeviceDesc device_desc(const SimulationDesc& desc) {
  DeviceDesc device = desc.device;
  if (desc.progress) device.progress = desc.progress;
  return device;
}

// Always a selection: a simulation reads what its sensors need.
SensorSelection first_selection(const std::vector<std::string>& sensors) {
  return [sensors](std::string_view name) { return sensors.empty() || std::ranges::count(sensors, name) > 0; };
}

}  // namespace

void ReadInputs::add(const InputLog& log) {
  std::set<std::filesystem::path> all(files.begin(), files.end());
  all.insert(log.files().begin(), log.files().end());
  files.assign(all.begin(), all.end());
  environment.insert(log.environment().begin(), log.environment().end());
}

SimulationImpl::SimulationImpl(const SimulationDesc& simulation_desc, std::span<const Command> commands,
                               std::string scene_name)
    : desc(simulation_desc),
      timeline(desc.rate_hz, desc.frames_when_due),
      scene(desc.overrides, commands, desc.seed, desc.progress, desc.packages, desc.strict,
            first_selection(desc.sensors)),
      device(device_desc(desc), desc.threads),
      device_costs(device, cache_folder(desc.device.cache_dir)),
      sensing(scene.built.scene.root(), Audience::sensors, device),
      sensors(scene.built.sensors) {
  scene.built.name = std::move(scene_name);
  follow_scene();
  for (const std::string& sensor : desc.sensors) {
    try {
      sensors.index(sensor);
    } catch (const InputError& error) {
      throw InputError("setting \"sensors\", --sensor: " + std::string(error.what()));
    }
  }
  for (const BuiltSensor& sensor : scene.built.sensors) {
    if (!first_selection(desc.sensors)(sensor.name)) enable(sensor.name, false);
  }
  scene.select([this](std::string_view sensor) { return is_on(sensor); });
  scene.require([this]() -> const TargetLimits& { return device.open().target_limits(); });
  scene.check_changes([this](const BuiltScene& built) { outlets.check(built); });
}

bool SimulationImpl::is_on(std::string_view sensor) const {
  const std::vector<BuiltSensor>& built = scene.built.sensors;
  const auto found = std::ranges::find(built, sensor, &BuiltSensor::name);
  if (found == built.end()) return true;
  const auto state = std::ranges::find(sensors.all, found->id, &SensorState::sensor);
  return state == sensors.all.end() || state->enabled;
}

void SimulationImpl::enable(std::string_view name, bool on) {
  const std::size_t index = sensors.index(name);
  SensorState& state = sensors.all[index];
  if (state.enabled == on) return;
  state.enabled = on;
  try {
    if (on) load_for(*scene.built.sensors[index].sensor);
  } catch (...) {
    state.enabled = false;
    throw;
  }
  sensed.enable(state.sensor, on);
}

void SimulationImpl::load_for(const Sensor& sensor) {
  if (sensor.draws()) sensor.check(device.open().target_limits());
  const InputLog log;
  scene.read_for_sensors();
  inputs.add(log);
}

void SimulationImpl::follow_scene() {
  if (const auto physics = find_physics(scene.built.scene)) physics->report_to(desc.progress);
  const bool removed = sensors.follow([this](const BuiltSensor& added) {
    const SensorType* const type = find_sensor_type(added.type);
    if (type->measure_costs == nullptr) return;
    added.sensor->use_cost_model([this, type]() -> const CostModel& { return device_costs.of(*type); });
  });
  if (removed) {  // the plans of the last frame name sensors that are not there any more
    sensing.begin_plan();
    if (visualization) visualization->begin_plan();
  }
  sensed.follow(scene.built, sensing.flattener);
  tracked_parts.follow(scene.built.scene);
  const bool wanted = std::ranges::any_of(scene.built.sensors,
                                          [](const BuiltSensor& sensor) { return sensor.sensor->visualization(); });
  if (wanted && !visualization) visualization.emplace(scene.built.scene.root(), Audience::people, device);
  if (!wanted) visualization.reset();
}

bool SimulationImpl::pose(const BuiltSensor& sensor, glm::dmat4& world_from_sensor) {
  glm::dmat4 world_from_mount;
  if (!layer_of(sensor).flattener.find_mount(*sensor.mount, world_from_mount)) return false;
  if (rigid_mount_frame(world_from_mount, world_from_sensor)) return true;
  throw InputError("sensor \"" + sensor.name +
                   "\" has no direction: its insertion point is scaled to zero or is infinitely far away");
}

bool SimulationImpl::find_mount(const Mount& mount, glm::dmat4& world_from_mount) const {
  return visualization->flattener.find_mount(mount, world_from_mount);
}

std::vector<SceneItem> SimulationImpl::items() {
  std::vector<SceneItem> items;
  if (sensing.list == nullptr) return items;
  read_shapes("the table of items");
  const ObjectIds& ids = sensed.object_ids(scene.built.scene, sensing.flattener);
  for (const ItemSource& source : sensing.flattener.item_sources()) {
    const Mesh& mesh = *source.shape->mesh();
    const auto item = static_cast<std::uint32_t>(items.size());
    items.push_back({.part = source.point == nullptr ? "" : source.point->name,
                     .mesh = source.shape->name.empty() ? mesh.name : source.shape->name,
                     .triangles = mesh.topology == Topology::triangles ? mesh.indices.size() / 3 : 0,
                     .instance = ids.ids().instance[item],
                     .semantic = ids.ids().semantic[item],
                     .label = ids.class_name(item),
                     .shape = ids.ids().shape[item]});
  }
  return items;
}

std::vector<SceneObject> SimulationImpl::objects() {
  if (sensing.list == nullptr) return {};
  read_shapes("the table of objects");
  const std::span<const SceneObject> all =
      sensed.object_ids(scene.built.scene, sensing.flattener).objects(sensing.flattener, *sensing.list);
  return {all.begin(), all.end()};
}

void SimulationImpl::execute_request(std::span<const Command> commands) {
  const InputLog log;
  scene.execute(commands);
  inputs.add(log);
  follow_scene();
}

SimulationImpl& SimulationImpl::idle() {
  if (under_way) throw InputError("a frame is under way, expected finish() before this");
  return *this;
}

}  // namespace simvis
