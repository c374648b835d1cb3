#include "simvis/view_layer.h"

#include <utility>

#include <simvis/effect.h>

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
  if (device.instrumented()) renderer.emplace(device.open());
}

void ViewLayer::begin_plan() {
  plan.passes.clear();
  plan.casts.clear();
  plan.effects.clear();
  entries.clear();
  rendered = complete = false;
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
