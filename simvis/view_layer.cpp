#include "simvis/view_layer.h"

#include <utility>

#include <simvis/effect.h>
#include <simvis/sensor_type.h>
#include "engine/splats/seen_splats.h"

namespace simvis {

namespace {

std::vector<std::string> outputs_of(const Sensor& sensor) {
  std::vector<std::string> outputs;
  if (sensor.scan() != nullptr) return {"ranges"};
  for (const MeasuredArray& each : sensor.measurement().arrays) outputs.push_back(each.name);
  return outputs;
}

}  // namespace

ViewLayer::ViewLayer(GroupPtr root, Audience audience, LazyDevice& device_of_simulation)
    : device(device_of_simulation),
      flattener(std::move(root), audience),
      ignored(audience),
      caster(device.host_caster()),
      list(&flattener.update()) {
  plan.threads = caster->threads();
  if (device.instrumented()) renderer.emplace(device.open());
}

void ViewLayer::begin_plan() {
  plan.passes.clear();
  plan.casts.clear();
  plan.effects.clear();
  entries.clear();
  rendered = complete = false;
}

bool ViewLayer::has_splats() {
  const std::uint64_t structure = list->revisions.structure;
  if (!known_splats || known_splats->first != structure) known_splats = {structure, simvis::has_splats(*list)};
  return known_splats->second;
}

RayCaster& ViewLayer::caster_for(const SensorType& type) {
  if ((type.capabilities & kRaysHitSplats) != 0 && has_splats()) return splat_caster;
  return *caster;
}

void ViewLayer::finish_plan() {
  if (!plan.passes.empty()) {
    plan_frame_effects(*list, device.open().target_limits(), plan);
    if (!renderer) renderer.emplace(device.open());
  }
  if (!plan.casts.empty() && !std::exchange(has_cast, true)) caster = device.caster();
  for (RayCast& cast : plan.casts) cast.engine = caster->engine();
}

void ViewLayer::submit() {
  if (renderer) renderer->submit(*list, plan);
}

std::span<const PassResult> ViewLayer::collect() {
  return renderer ? renderer->collect() : std::span<const PassResult>();
}

const FrameCounters& ViewLayer::counters() const {
  static const FrameCounters kNone;
  return renderer ? renderer->counters() : kNone;
}

const FramePlan& ViewLayer::complete_plan() {
  if (complete) return plan;
  complete = true;
  plan.memory.clear();
  if (!rendered) return plan;
  if (renderer) renderer->complete(plan);
  caster->name_memory(plan.memory);
  return plan;
}

std::vector<PlannedSensor> ViewLayer::planned_sensors(std::span<const BuiltSensor> sensors) const {
  std::vector<PlannedSensor> planned;
  for (const Entry& entry : entries) {
    const BuiltSensor& sensor = sensors[entry.sensor];
    planned.push_back({.name = sensor.name,
                       .type = sensor.type,
                       .due_state = entry.due_state,
                       .rate_hz = sensor.sensor->rate_hz,
                       .outputs = outputs_of(*sensor.sensor),
                       .first_pass = entry.first_pass,
                       .end_pass = entry.end_pass,
                       .first_cast = entry.first_cast,
                       .end_cast = entry.end_cast});
  }
  return planned;
}

}  // namespace simvis
