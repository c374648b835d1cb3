// Frames that a simulation skips, and what their sensors measure of them after all.
#include <algorithm>
#include <string>
#include <utility>

#include <simvis/effect.h>
#include <simvis/sensor_type.h>
#include "simvis/element_motion.h"
#include "simvis/simulation_impl.h"

namespace simvis {
namespace {

// Types of which a scene chooses the method.
bool has_methods(const std::string& type) {
  const SensorType* const found = find_sensor_type(type);
  return found != nullptr && std::ranges::count(found->attributes, "method", &AttributeSpec::name) > 0;
}

}  // namespace

// A skipped frame measures nothing, so it computes only the poses of sensors.
void SimulationImpl::skip_frame() {
  require_skippable();
  const FrameTime time = next_frame();
  // Those that are due again need this frame instead.
  std::erase_if(skipped.sensors,
                [&](std::size_t i) { return timeline.fires(scene.built.sensors[i].sensor->rate_hz, time); });
  measure_skipped();
  bool looked_back_at = false;
  for (std::size_t i = 0; i < sensors.all.size(); ++i) {
    looked_back_at |=
        sensors.all[i].enabled && scene.built.sensors[i].sensor->history_dependence() != HistoryDependence::none;
  }
  if (looked_back_at || has_motion(scene.built)) move_elements(time);
  if (looked_back_at) {
    flatten(sensing);
    sensed.update(scene.built, sensing.flattener, *sensing.list, time);
    for (std::size_t i = 0; i < sensors.all.size(); ++i) {
      if (due_state(i, time) != DueState::due) continue;
      Sensor& sensor = *scene.built.sensors[i].sensor;
      const std::size_t id = sensors.all[i].sensor;
      const SensedWorld* const world = sensed.look(id, sensing.ignored.seen_list(id, *sensing.list), time);
      if (world != nullptr && sensor.needs().scene) sensor.sense(*world);
      sensor.skip_frame(time, sensors.all[i].world_from_sensor);
      if (sensor.history_dependence() == HistoryDependence::last_measurement) skipped.sensors.push_back(i);
    }
  }
  skipped.frame = time;
  timeline.go_on(time);
}

void SimulationImpl::require_skippable() const {
  for (std::size_t i = 0; i < sensors.all.size(); ++i) {
    const BuiltSensor& built = scene.built.sensors[i];
    if (!sensors.all[i].enabled || built.sensor->history_dependence() != HistoryDependence::measurements) continue;
    throw InputError("sensor \"" + built.name + "\" of type " + built.type + " (" + built.sensor->method() +
                     ") depends on the frames before, so no frame can be skipped; expected " +
                     (!built.sensor->visualization() && has_methods(built.type) ? "another method, or it to be off"
                                                                                : "it to be off"));
  }
}

// Nobody sees these measurements: a sensor's last one stays that of a frame that was made.
void SimulationImpl::measure_skipped() {
  const std::vector<std::size_t> due = std::exchange(skipped.sensors, {});
  if (due.empty()) return;
  std::vector<Measurement> shown;
  shown.reserve(due.size());
  for (const std::size_t i : due) shown.push_back(sensors.measurement(i));
  sensing.begin_plan();
  for (const std::size_t i : due) plan_sensor(sensing, i, skipped.frame);
  sensing.finish_plan();
  sensing.caster->set_world(*sensing.list);
  sensing.submit();
  const std::span<const PassResult> results = sensing.collect();
  for (std::size_t k = 0; k < due.size(); ++k) {
    Sensor& sensor = *scene.built.sensors[due[k]].sensor;
    sensor.collect(skipped.frame, sensing.plan, results);
    sensing.caster->ignore(sensing.ignored.of(sensors.all[due[k]].sensor));
    sensor.cast(*sensing.caster);
    sensors.all[due[k]].measurement = std::move(shown[k]);
  }
}

}  // namespace simvis
