#include "simvis/simulation_impl.h"

#include <algorithm>
#include <exception>
#include <mutex>
#include <set>
#include <utility>

#include <simvis/cost_model.h>
#include <simvis/effect.h>
#include <simvis/version.h>
#include "engine/base/cache_file.h"
#include "engine/base/now_ns.h"
#include "scenegraph/clone_graph.h"
#include "sensors/output_check.h"
#include "simvis/element_motion.h"
#include "simvis/mount_frame.h"

namespace simvis {

namespace {

std::size_t count_views(const FramePlan& plan) {
  std::size_t views = 0;
  for (const Pass& pass : plan.passes) views += pass.views.size();
  return views;
}

// The device reports progress to the same callback as the simulation.
DeviceDesc device_desc(const SimulationDesc& desc) {
  DeviceDesc device = desc.device;
  if (desc.progress) device.progress = desc.progress;
  return device;
}

}  // namespace

SimulationImpl::SimulationImpl(const SimulationDesc& desc, std::span<const Command> commands, std::string scene_name)
    : name(std::move(scene_name)),
      rate_hz(desc.rate_hz),
      frames_when_due(desc.frames_when_due),
      elements_move(desc.elements_move),
      progress(desc.progress),
      timeline(desc.rate_hz, desc.frames_when_due),
      scene(desc.overrides, commands, desc.seed, desc.progress, desc.packages, desc.strict),
      cache(cache_folder(desc.device.cache_dir)),
      device(device_desc(desc), desc.threads),
      sensing(scene.built.scene.root(), Audience::sensors, device),
      instrumented(desc.device.instrumented) {
  scene.require(device.target_limits());
  scene.check_changes([this](const BuiltScene& built) { outlets.check(built); });
  follow_scene();
}

// Called after each change of the scene: what frames need of it follows.
void SimulationImpl::follow_scene() {
  if (const auto physics = find_physics(scene.built.scene)) physics->report_to(progress);
  follow_sensors();
  sensed.follow(scene.built, sensing.flattener);
  follow_tracked_parts();
  const bool wanted = std::ranges::any_of(scene.built.sensors,
                                          [](const BuiltSensor& sensor) { return sensor.sensor->visualization(); });
  if (wanted && !visualization) visualization.emplace(scene.built.scene.root(), Audience::people, device);
  if (!wanted) visualization.reset();
}

void SimulationImpl::follow_sensors() {
  std::vector<State> before = std::move(states);
  states.clear();
  auto known = before.begin();  // both are in the order of ids
  bool removed = false;
  for (const BuiltSensor& built : scene.built.sensors) {
    for (; known != before.end() && known->sensor < built.id; ++known) removed = true;
    if (known != before.end() && known->sensor == built.id) {
      states.push_back(std::move(*known++));
      continue;
    }
    states.emplace_back().sensor = built.id;
    const SensorType* const type = find_sensor_type(built.type);
    if (type->measure_costs == nullptr) continue;
    built.sensor->use_cost_model([this, type]() -> const CostModel& { return costs(*type); });
  }
  if (!removed && known == before.end()) return;
  std::erase_if(shown_scans, [&](const auto& shown) {
    return std::ranges::count(scene.built.sensors, shown.first, &BuiltSensor::id) == 0;
  });
  // The plans of the last frame name sensors that are not there any more.
  sensing.begin_plan();
  if (visualization) visualization->begin_plan();
}

// The mount of a part goes with the part. A new part of the same name is tracked again.
void SimulationImpl::follow_tracked_parts() {
  if (tracked_parts.empty()) return;
  const std::vector<NodePtr> nodes = nodes_of(scene.built.scene.root());
  const std::set<NodePtr> there(nodes.begin(), nodes.end());
  for (auto& [part, mount] : tracked_parts) {
    if (there.contains(mount)) continue;
    mount = scene.built.scene.has_insertion_point(part) ? add_mount(part) : nullptr;
  }
}

const CostModel& SimulationImpl::costs(const SensorType& type) {
  if (!device_costs) {
    // Simulations that measure at the same time would disturb each other. With a cache, one measurement serves all.
    static std::mutex measuring;
    const std::lock_guard lock(measuring);
    const std::filesystem::path file = cost_model_file(device, cache, version());
    device_costs = load_cost_model(file);
    const std::unique_ptr<RayCaster> rays = make_ray_caster(device);
    if (!device_costs) device_costs = save_cost_model(file, type.measure_costs(device, *rays));
  }
  return *device_costs;
}

// The rates of the sensors that are on and have one.
std::vector<double> SimulationImpl::rates() const {
  std::vector<double> rates;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const double rate = scene.built.sensors[i].sensor->rate_hz;
    if (states[i].enabled && rate > 0) rates.push_back(rate);
  }
  return rates;
}

FrameTime SimulationImpl::next_frame() const {
  if (!under_way) return timeline.next(rates());
  Timeline after = timeline;
  after.go_on(frame);
  return after.next(rates());
}

void SimulationImpl::step() {
  finish();
  measured.clear();
  start();
  finish();
}

void SimulationImpl::step(std::chrono::nanoseconds dt) {
  finish();
  timeline.stretch(dt);
  step();
}

void SimulationImpl::start() {
  warn_before_measuring();
  measure_skipped();
  const FrameTime time = next_frame();
  stages.clear();
  outlets.take_inputs(scene.built, time, moved_to_ns, stages,
                      [this](std::span<const Command> all) { execute_request(all); });
  stages.begin("elements");
  move_elements(time);
  outlets.follow_values(scene.built.parameters);
  stages.begin("flatten");
  sensing.list = &sensing.flattener.update();
  sensed.update(scene.built, sensing.flattener, *sensing.list, time);
  stages.begin("plan");
  plan_due_sensors(sensing, false, time);
  if (scene.built.scene.has_postponed_pictures() && needs_pictures()) {
    read_pictures();
    plan_due_sensors(sensing, false, time);
  }
  stages.begin("render");
  sensing.renderer.submit(*sensing.list, sensing.plan);
  frame = time;
  under_way = true;
}

// Cameras have their pictures since they were inserted. Other sensors may look at colours too: one of light draws them,
// and the intensity of a scanner's beam depends on them.
bool SimulationImpl::needs_pictures() const {
  return reads_all_pictures || std::ranges::any_of(sensing.plan.passes, &Pass::color) ||
         std::ranges::any_of(sensing.plan.casts, &RayCast::colors);
}

void SimulationImpl::read_pictures() {
  const InputLog log;
  scene.built.scene.read_pictures();
  scene.built.scene.undo().commit();
  add_inputs(log);
  sensing.list = &sensing.flattener.update();
}

void SimulationImpl::finish() {
  if (!under_way) return;
  under_way = false;
  measured.clear();
  sensor_costs.clear();
  std::vector<PlacedSensor> placed;
  try {
    render(sensing, frame);
    if (visualization) {
      stages.begin("visualization");
      draw_visualization(frame);
    }
    if (!outlets.empty()) placed = placed_sensors();
  } catch (...) {
    discard_measurements();
    throw;
  }
  stages.end();
  timeline.go_on(frame);
  made = frame;
  if (!outlets.empty()) offer_frame(placed);
}

// The frame counts as not made, also if only the visualization has failed.
void SimulationImpl::discard_measurements() {
  for (const std::string& sensor : measured) --states[index(sensor)].frames;
  measured.clear();
  sensor_costs.clear();
}

// The frame is made. An outlet can neither undo nor repeat it.
void SimulationImpl::offer_frame(std::span<const PlacedSensor> placed) {
  outlets.offer({frame, scene.built, placed}, stages);
  for (const std::string& warning : outlets.take_warnings()) warn(warning);
}

void SimulationImpl::execute_request(std::span<const Command> commands) {
  const InputLog inputs;
  scene.execute(commands);
  add_inputs(inputs);
  follow_scene();
}

// A sensor that is not due may have no direction: that is an error of the frame in which it is due.
std::vector<PlacedSensor> SimulationImpl::placed_sensors() {
  std::vector<PlacedSensor> placed;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const BuiltSensor& sensor = scene.built.sensors[i];
    const bool has_measured = std::ranges::find(measured, sensor.name) != measured.end();
    glm::dmat4 world_from_sensor = states[i].world_from_sensor, world_from_mount;
    const bool is_placed =
        has_measured || (states[i].enabled && layer_of(sensor).flattener.find_mount(*sensor.mount, world_from_mount) &&
                         rigid_mount_frame(world_from_mount, world_from_sensor));
    if (!is_placed) continue;
    placed.push_back({sensor, world_from_sensor, has_measured ? &measurement(i) : nullptr});
  }
  return placed;
}

// All that anything reads of a sensor's measurement comes through here, where it is checked once.
const Measurement& SimulationImpl::measurement(std::size_t i) {
  State& state = states[i];
  if (state.measurement) return *state.measurement;
  const BuiltSensor& built = scene.built.sensors[i];
  Measurement now = built.sensor->measurement();
  const std::string different = measurement_difference(*built.sensor, now, built.outputs, state.frames > 0);
  if (!different.empty()) fail_at(built.command.where, "sensor " + in_quotes(built.name) + ": " + different);
  for (MeasuredArray& each : now.arrays) {
    if (const OutputSpec* const listed = find_output(built.outputs, each.name)) describe(each, *listed);
  }
  return state.measurement.emplace(std::move(now));
}

// Host-only ray casts run while the device draws for the other sensors.
void SimulationImpl::render(ViewLayer& layer, const FrameTime& time) {
  layer.caster->set_world(*layer.list);
  std::exception_ptr failed;
  try {
    for (ViewLayer::Entry& entry : layer.entries) {
      const bool ready = !entry.draws && layer.caster->on_host();
      if (entry.due_state == DueState::due && ready) measure(layer, entry, time, {});
    }
  } catch (...) {
    failed = std::current_exception();
  }
  const std::span<const PassResult> results = layer.renderer.collect();
  if (failed) std::rethrow_exception(failed);
  if (&layer == &sensing) stages.begin("collect");
  measure(layer, time, results);
}

SimulationImpl& SimulationImpl::idle() {
  if (under_way) throw InputError("a frame is under way, expected finish() before this");
  return *this;
}

void SimulationImpl::draw_visualization(const FrameTime& time) {
  bool is_shown = false;
  for (std::size_t i = 0; i < states.size(); ++i) {
    is_shown |= states[i].enabled && scene.built.sensors[i].sensor->visualization();
  }
  if (is_shown) {
    visualization->list = &visualization->flattener.update();
    for (const std::unique_ptr<Element>& element : scene.built.elements) {
      if (element != nullptr) element->observe(*this);
    }
    visualization->list = &visualization->flattener.update();
  }
  plan_due_sensors(*visualization, true, time);
  visualization->renderer.submit(*visualization->list, visualization->plan);
  render(*visualization, time);
}

void SimulationImpl::move_elements(const FrameTime& time) {
  if (elements_move) {
    follow_commands(command_sources.of(scene.built), scene.built, moved_to_ns, time.time_ns);
    advance_elements(scene.built, time);
  } else {
    update_elements(scene.built);
  }
  moved_to_ns = time.time_ns;
}

void SimulationImpl::plan_sensor(ViewLayer& layer, std::size_t i, const FrameTime& time) {
  Sensor& sensor = *scene.built.sensors[i].sensor;
  states[i].measurement.reset();  // the sensor writes to its memory again
  sensor.begin(time);
  if (const SensedWorld* const world = sensed.look(states[i].sensor, time)) sensor.sense(*world);
  sensor.plan(states[i].world_from_sensor, *layer.list, layer.plan);
}

void SimulationImpl::plan_due_sensors(ViewLayer& layer, bool for_people, const FrameTime& time) {
  layer.begin_plan();
  FramePlan& plan = layer.plan;
  for (std::size_t i = 0; i < states.size(); ++i) {
    Sensor& sensor = *scene.built.sensors[i].sensor;
    if (sensor.visualization() != for_people) continue;
    ViewLayer::Entry entry{.sensor = i,
                           .due_state = due_state(i, time),
                           .first_pass = plan.passes.size(),
                           .first_cast = plan.casts.size()};
    if (entry.due_state == DueState::due) {
      const std::size_t views = count_views(plan);
      plan_sensor(layer, i, time);
      entry.draws = count_views(plan) > views;
    }
    entry.end_pass = plan.passes.size();
    entry.end_cast = plan.casts.size();
    layer.entries.push_back(entry);
    plan_scene_effects(scene.built.sensors[i].name, entry.first_pass, *layer.list, plan);
  }
  plan_frame_effects(*layer.list, device.target_limits(), plan);
  for (RayCast& cast : plan.casts) cast.engine = layer.caster->engine();
  for (const PlannedEffect& planned : plan.effects) {
    std::vector<std::string>& effects = states[index(planned.sensor)].effects;
    if (std::ranges::find(effects, planned.effect) == effects.end()) effects.push_back(planned.effect);
  }
}

// Also updates the pose of the sensor if it is due.
DueState SimulationImpl::due_state(std::size_t sensor, const FrameTime& time) {
  const BuiltSensor& built = scene.built.sensors[sensor];
  if (!states[sensor].enabled) return DueState::off;
  if (!timeline.fires(built.sensor->rate_hz, time)) return DueState::waiting;
  return pose(built, states[sensor].world_from_sensor) ? DueState::due : DueState::hidden;
}

void SimulationImpl::measure(ViewLayer& layer, const FrameTime& time, std::span<const PassResult> results) {
  layer.rendered = true;
  for (ViewLayer::Entry& entry : layer.entries) {
    if (entry.due_state == DueState::due && !entry.taken) measure(layer, entry, time, results);
  }
  for (ViewLayer::Entry& entry : layer.entries) {
    if (entry.due_state != DueState::due) continue;
    ++states[entry.sensor].frames;
    measured.push_back(scene.built.sensors[entry.sensor].name);
    if (instrumented) sensor_costs.push_back(std::move(entry.cost));
  }
  warn_of_unseen_splats(layer);
  warn_of_empty_views(layer, results);
}

void SimulationImpl::measure(ViewLayer& layer, ViewLayer::Entry& entry, const FrameTime& time,
                             std::span<const PassResult> results) {
  const BuiltSensor& sensor = scene.built.sensors[entry.sensor];
  entry.taken = true;
  states[entry.sensor].measurement.reset();
  if (!instrumented) {
    sensor.sensor->collect(time, layer.plan, results);
    sensor.sensor->cast(*layer.caster);
    return;
  }
  const RayCounters before = layer.caster->counters();
  entry.cost = {.sensor = sensor.name, .start_ns = now_ns()};
  sensor.sensor->collect(time, layer.plan, results);
  entry.cost.collected_ns = now_ns();
  sensor.sensor->cast(*layer.caster);
  entry.cost.end_ns = now_ns();
  const RayCounters after = layer.caster->counters();
  entry.cost.rays = after.rays - before.rays;
  entry.cost.item_tests = after.item_tests - before.item_tests;
  entry.cost.triangle_tests = after.triangle_tests - before.triangle_tests;
}

/// Returns false if the sensor is mounted in a part that is switched off.
bool SimulationImpl::pose(const BuiltSensor& sensor, glm::dmat4& world_from_sensor) {
  glm::dmat4 world_from_mount;
  if (!layer_of(sensor).flattener.find_mount(*sensor.mount, world_from_mount)) return false;
  if (rigid_mount_frame(world_from_mount, world_from_sensor)) return true;
  throw InputError("sensor \"" + sensor.name +
                   "\" has no direction: its insertion point is scaled to zero or is infinitely far away");
}

void SimulationImpl::add_inputs(const InputLog& log) {
  std::set<std::filesystem::path> all(inputs.begin(), inputs.end());
  all.insert(log.files().begin(), log.files().end());
  inputs.assign(all.begin(), all.end());
  environment.insert(log.environment().begin(), log.environment().end());
}

std::vector<SceneItem> SimulationImpl::items() {
  std::vector<SceneItem> items;
  if (sensing.list == nullptr) return items;
  const ItemIdTable& ids = sensed.item_ids(scene.built.scene, sensing.flattener);
  for (const ItemSource& source : sensing.flattener.item_sources()) {
    const Mesh& mesh = *source.shape->mesh();
    const auto item = static_cast<std::uint32_t>(items.size());
    items.push_back({.part = source.point == nullptr ? "" : source.point->name,
                     .mesh = source.shape->name.empty() ? mesh.name : source.shape->name,
                     .triangles = mesh.topology == Topology::triangles ? mesh.indices.size() / 3 : 0,
                     .instance = ids.ids().instance[item],
                     .semantic = ids.ids().semantic[item],
                     .label = ids.class_name(item)});
  }
  return items;
}

void SimulationImpl::track_part(std::string_view part) {
  if (tracked_parts.contains(part)) return;
  Scene& built = scene.built.scene;
  if (!built.has_insertion_point(part)) {
    throw InputError("there is no part \"" + std::string(part) + "\"" + suggestion(part, built.insertion_points()));
  }
  tracked_parts.emplace(part, add_mount(part));
}

std::shared_ptr<Mount> SimulationImpl::add_mount(std::string_view part) {
  const auto mount = std::make_shared<Mount>();
  mount->name = part;
  scene.built.scene.insert_behind_point(part, mount);
  scene.built.scene.undo().commit();
  return mount;
}

bool SimulationImpl::part_pose(std::string_view part, glm::dmat4& world_from_part) const {
  const auto found = tracked_parts.find(part);
  if (found == tracked_parts.end()) {
    throw InputError("part \"" + std::string(part) + "\" is not tracked, expected track_part() before");
  }
  glm::dmat4 world_from_mount;
  return found->second != nullptr && sensing.flattener.find_mount(*found->second, world_from_mount) &&
         rigid_mount_frame(world_from_mount, world_from_part);
}

std::size_t SimulationImpl::index(std::string_view name) const {
  std::vector<std::string_view> known;
  for (std::size_t i = 0; i < scene.built.sensors.size(); ++i) {
    if (scene.built.sensors[i].name == name) return i;
    known.push_back(scene.built.sensors[i].name);
  }
  throw InputError("there is no sensor \"" + std::string(name) + "\"" + suggestion(name, known));
}

ObservedScan SimulationImpl::scan(std::string_view name) const {
  const std::size_t i = index(name);
  const auto shown = shown_scans.find(states[i].sensor);
  if (shown != shown_scans.end()) {
    return {&shown->second.scan, shown->second.scan.world_from_sensor, shown->second.count};
  }
  if (states[i].frames == 0) return {};
  return {scene.built.sensors[i].sensor->scan(), states[i].world_from_sensor, states[i].frames};
}

bool SimulationImpl::find_mount(const Mount& mount, glm::dmat4& world_from_mount) const {
  return visualization->flattener.find_mount(mount, world_from_mount);
}

}  // namespace simvis
