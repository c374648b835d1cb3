// The stages of a frame: its elements move, sensors plan, the device works, sensors measure, outlets get the frame.
#include <algorithm>
#include <exception>

#include <simvis/effect.h>
#include "engine/base/now_ns.h"
#include "engine/splats/seen_splats.h"
#include "sensors/delayed_sensor.h"
#include "simvis/element_motion.h"
#include "simvis/mount_frame.h"
#include "simvis/simulation_impl.h"

namespace simvis {
namespace {

std::size_t count_views(const FramePlan& plan) {
  std::size_t views = 0;
  for (const Pass& pass : plan.passes) views += pass.views.size();
  return views;
}

}  // namespace

FrameTime SimulationImpl::next_frame() const {
  if (!under_way) return timeline.next(sensors.rates());
  Timeline after = timeline;
  after.go_on(frame);
  return after.next(sensors.rates());
}

void SimulationImpl::step() {
  finish();
  sensors.measured.clear();
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
  flatten(sensing);
  if (reads_all) read_shapes("a view of the scene");
  sensed.update(scene.built, sensing.flattener, *sensing.list, time);
  stages.begin("plan");
  plan_due_sensors(sensing, false, time);
  if (scene.built.scene.has_postponed_pictures() && needs_pictures()) {
    read_pictures();
    plan_due_sensors(sensing, false, time);
  }
  stages.begin("render");
  sensing.submit();
  frame = time;
  under_way = true;
}

// Cameras have their pictures since they were inserted. Other sensors may look at colours too: one of light draws them,
// and the intensity of a scanner's beam depends on them.
bool SimulationImpl::needs_pictures() const {
  return reads_all || std::ranges::any_of(sensing.plan.passes, &Pass::color) ||
         std::ranges::any_of(sensing.plan.casts, &RayCast::colors);
}

void SimulationImpl::read_pictures() {
  const InputLog log;
  scene.built.scene.read_pictures("what is drawn or cast");
  scene.built.scene.undo().commit();
  inputs.add(log);
  flatten(sensing);
}

void SimulationImpl::read_shapes(const std::string& needed_by) {
  Scene& built = scene.built.scene;
  if (!built.has_postponed_shapes()) return;
  const InputLog log;
  try {
    built.read_shapes(needed_by);
  } catch (...) {
    built.undo().roll_back();
    throw;
  }
  built.undo().commit();
  inputs.add(log);
  flatten(sensing);
}

void SimulationImpl::flatten(ViewLayer& layer) {
  layer.list = &layer.flattener.update();
  layer.ignored.update(scene.built, layer.flattener, *layer.list,
                       [this](const std::string& warning) { warn(warning); });
}

void SimulationImpl::finish() {
  if (!under_way) return;
  under_way = false;
  sensors.begin_frame();
  std::vector<PlacedSensor> placed;
  try {
    render(sensing, frame);
    if (visualization) {
      stages.begin("visualization");
      draw_visualization(frame);
    }
    if (!outlets.empty()) placed = placed_sensors();
  } catch (...) {
    sensors.discard_frame();  // it counts as not made, also if only the visualization has failed
    throw;
  }
  stages.end();
  timeline.go_on(frame);
  made = frame;
  if (!outlets.empty()) offer_frame(placed);
}

// The frame is made. An outlet can neither undo nor repeat it.
void SimulationImpl::offer_frame(std::span<const PlacedSensor> placed) {
  const auto scene_objects = [this] {
    return sensed.object_ids(scene.built.scene, sensing.flattener).objects(sensing.flattener, *sensing.list);
  };
  outlets.offer({frame, scene.built, placed, *sensing.list, scene_objects}, stages);
  for (const std::string& warning : outlets.take_warnings()) warn(warning);
}

// A sensor that is not due may have no direction: that is an error of the frame in which it is due.
std::vector<PlacedSensor> SimulationImpl::placed_sensors() {
  std::vector<PlacedSensor> placed;
  for (std::size_t i = 0; i < sensors.all.size(); ++i) {
    const BuiltSensor& sensor = scene.built.sensors[i];
    const bool has_measured = std::ranges::find(sensors.measured, sensor.name) != sensors.measured.end();
    glm::dmat4 world_from_sensor = sensors.all[i].world_from_sensor, world_from_mount;
    // A measurement that arrives late says nothing of where the sensor is now.
    const bool is_current = has_measured && sensor.delayed == nullptr;
    const bool is_placed = is_current || (sensors.all[i].enabled &&
                                          layer_of(sensor).flattener.find_mount(*sensor.mount, world_from_mount) &&
                                          rigid_mount_frame(world_from_mount, world_from_sensor));
    if (!is_placed && !has_measured) continue;
    placed.push_back({sensor, world_from_sensor, has_measured ? &sensors.measurement(i) : nullptr});
  }
  return placed;
}

// Host-only ray casts run while the device draws for the other sensors.
void SimulationImpl::render(ViewLayer& layer, const FrameTime& time) {
  if (layer.has_splats()) {
    layer.splat_caster.set_world(*layer.list, *layer.caster);
  } else {
    layer.caster->set_world(*layer.list);
  }
  std::exception_ptr failed;
  try {
    for (ViewLayer::Entry& entry : layer.entries) {
      const bool ready = !entry.draws && layer.caster->on_host();
      if (entry.due_state == DueState::due && ready) measure(layer, entry, time, {});
    }
  } catch (...) {
    failed = std::current_exception();
  }
  const std::span<const PassResult> results = layer.collect();
  if (failed) std::rethrow_exception(failed);
  if (&layer == &sensing) stages.begin("collect");
  measure(layer, time, results);
}

void SimulationImpl::draw_visualization(const FrameTime& time) {
  bool is_shown = false;
  for (std::size_t i = 0; i < sensors.all.size(); ++i) {
    is_shown |= sensors.all[i].enabled && scene.built.sensors[i].sensor->visualization();
  }
  if (is_shown) {
    flatten(*visualization);
    for (const std::unique_ptr<Element>& element : scene.built.elements) {
      if (element != nullptr) element->observe(*this);
    }
    flatten(*visualization);
  }
  plan_due_sensors(*visualization, true, time);
  visualization->submit();
  render(*visualization, time);
}

void SimulationImpl::move_elements(const FrameTime& time) {
  if (desc.elements_move) {
    follow_commands(command_sources.of(scene.built), scene.built, moved_to_ns, time.time_ns);
    advance_elements(scene.built, time);
  } else {
    update_elements(scene.built);
  }
  moved_to_ns = time.time_ns;
}

void SimulationImpl::plan_sensor(ViewLayer& layer, std::size_t i, const FrameTime& time) {
  const BuiltSensor& built = scene.built.sensors[i];
  Sensor& sensor = *built.sensor;
  const std::size_t id = sensors.all[i].sensor;
  const DrawList& list = layer.ignored.seen_list(id, *layer.list);
  sensors.all[i].measurement.reset();  // the sensor writes to its memory again
  sensor.begin(time);
  if (const SensedWorld* const world = sensed.look(id, list, time)) sensor.sense(*world);
  const std::vector<std::size_t> views =
      &list == layer.list ? std::vector<std::size_t>() : IgnoredItems::count_views(layer.plan);
  const std::size_t casts = layer.plan.casts.size();
  sensor.plan(sensors.all[i].world_from_sensor, list, layer.plan);
  const bool hits_splats = (find_sensor_type(built.type)->capabilities & kRaysHitSplats) != 0;
  if (hits_splats && layer.has_splats() && layer.plan.casts.size() > casts && has_splats(list)) {
    layer.plan.effects.push_back(
        {built.name, "gaussian_splats", std::string(find_effect_type("gaussian_splats")->source)});
  }
  if (&list == layer.list) return;
  const std::string warning = layer.ignored.leave_out(id, views, casts, layer.plan);
  if (!warning.empty()) warn(warning);
}

void SimulationImpl::plan_due_sensors(ViewLayer& layer, bool for_people, const FrameTime& time) {
  layer.begin_plan();
  FramePlan& plan = layer.plan;
  for (std::size_t i = 0; i < sensors.all.size(); ++i) {
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
  layer.finish_plan();
  for (const PlannedEffect& planned : plan.effects) {
    std::vector<std::string>& effects = sensors.all[sensors.index(planned.sensor)].effects;
    if (std::ranges::find(effects, planned.effect) == effects.end()) effects.push_back(planned.effect);
  }
}

DueState SimulationImpl::due_state(std::size_t sensor, const FrameTime& time) {
  const BuiltSensor& built = scene.built.sensors[sensor];
  if (!sensors.all[sensor].enabled) return DueState::off;
  if (!timeline.fires(built.sensor->rate_hz, time)) return DueState::waiting;
  if (pose(built, sensors.all[sensor].world_from_sensor)) return DueState::due;
  sensed.hide(sensors.all[sensor].sensor);
  return DueState::hidden;
}

void SimulationImpl::measure(ViewLayer& layer, const FrameTime& time, std::span<const PassResult> results) {
  layer.rendered = true;
  for (ViewLayer::Entry& entry : layer.entries) {
    if (entry.due_state == DueState::due && !entry.taken) measure(layer, entry, time, results);
  }
  for (ViewLayer::Entry& entry : layer.entries) {
    if (arrives(entry, time)) sensors.add_measured(entry.sensor);
    if (entry.due_state == DueState::due && desc.device.instrumented) sensors.costs.push_back(std::move(entry.cost));
  }
  warn_of_unseen_splats(layer);
  warn_of_empty_views(layer, results);
}

bool SimulationImpl::arrives(const ViewLayer::Entry& entry, const FrameTime& time) {
  const bool has_measured = entry.due_state == DueState::due;
  DelayedSensor* const delayed = scene.built.sensors[entry.sensor].delayed;
  if (delayed == nullptr) return has_measured;
  const bool has_arrived = entry.due_state != DueState::off && delayed->pass_on(time, has_measured);
  if (entry.due_state == DueState::off) delayed->lose(time);
  if (has_arrived || delayed->is_made_again()) sensors.all[entry.sensor].measurement.reset();
  return has_arrived;
}

void SimulationImpl::measure(ViewLayer& layer, ViewLayer::Entry& entry, const FrameTime& time,
                             std::span<const PassResult> results) {
  const BuiltSensor& sensor = scene.built.sensors[entry.sensor];
  entry.taken = true;
  sensors.all[entry.sensor].measurement.reset();
  RayCaster& caster = layer.caster_for(*find_sensor_type(sensor.type));
  caster.ignore(layer.ignored.of(sensors.all[entry.sensor].sensor));
  if (!desc.device.instrumented) {
    sensor.sensor->collect(time, layer.plan, results);
    sensor.sensor->cast(caster);
    return;
  }
  const RayCounters before = layer.caster->counters();
  entry.cost = {.sensor = sensor.name, .start_ns = now_ns()};
  sensor.sensor->collect(time, layer.plan, results);
  entry.cost.collected_ns = now_ns();
  sensor.sensor->cast(caster);
  entry.cost.end_ns = now_ns();
  const RayCounters after = layer.caster->counters();
  entry.cost.rays = after.rays - before.rays;
  entry.cost.item_tests = after.item_tests - before.item_tests;
  entry.cost.triangle_tests = after.triangle_tests - before.triangle_tests;
}

}  // namespace simvis
