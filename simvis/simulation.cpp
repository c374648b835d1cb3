#include "simvis/simulation.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "engine/assert.h"
#include "scenegraph/flattener.h"
#include "simvis/clock.h"
#include "simvis/default_light.h"
#include "simvis/mount_frame.h"
#include "simvis/scene_builder.h"

namespace simvis {

namespace {

/// Notes when the stages of a step begin and end: each ends where the next begins.
class Stages {
 public:
  void clear() { stages_.clear(); }
  void begin(std::string_view name) {
    end();
    stages_.push_back({name, now_ns(), 0});
  }
  void end() {
    if (!stages_.empty() && stages_.back().end_ns == 0) stages_.back().end_ns = now_ns();
  }
  std::span<const StageTime> times() const { return stages_; }

 private:
  static std::int64_t now_ns() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  }
  std::vector<StageTime> stages_;
};

/// Whether a LightNode stands anywhere, also where a switch hides it for now.
bool has_light(const GroupPtr& root) {
  std::unordered_set<const Group*> seen{root.get()};
  std::vector<const Group*> open{root.get()};
  while (!open.empty()) {
    const Group* const group = open.back();
    open.pop_back();
    for (const NodePtr& child : group->children()) {
      if (child->kind() == NodeKind::light) return true;
      const auto* const inner = dynamic_cast<const Group*>(child.get());
      if (inner != nullptr && seen.insert(inner).second) open.push_back(inner);
    }
  }
  return false;
}

}  // namespace

struct Simulation::Impl {
  Impl(BuiltScene built, const SimulationDesc& desc);

  void step();
  void update_elements();
  void plan_due_sensors(const FrameTime& time);
  void collect(const FrameTime& time, std::span<const PassResult> results);
  bool pose(const BuiltSensor& sensor, glm::dmat4& world_from_sensor) const;
  std::size_t index(std::string_view sensor) const;

  struct State {
    bool enabled = true;
    std::uint64_t frames = 0;
  };

  Clock clock;
  BuiltScene built;
  std::vector<State> states;  // as long as built.sensors
  Device device;
  Renderer renderer;
  Flattener flattener;
  const DrawList* list;
  FramePlan plan;
  std::uint64_t next_frame = 0;
  std::vector<std::size_t> due;       // of this frame, indices of built.sensors
  std::vector<std::string> measured;  // their names
  Stages stages;
};

Simulation::Impl::Impl(BuiltScene from, const SimulationDesc& desc)
    : clock(desc.rate_hz),
      built(std::move(from)),
      states(built.sensors.size()),
      device(desc.device),
      renderer(device),
      flattener(built.scene->root()),
      list(&flattener.update()) {}

void Simulation::Impl::step() {
  const FrameTime time = clock.frame(next_frame);
  stages.clear();
  stages.begin("elements");
  update_elements();
  stages.begin("flatten");
  list = &flattener.update();
  stages.begin("plan");
  plan_due_sensors(time);
  stages.begin("render");
  const std::span<const PassResult> results = renderer.render(*list, plan);
  stages.begin("collect");
  collect(time, results);
  stages.end();
  ++next_frame;
}

void Simulation::Impl::update_elements() {
  for (const std::size_t i : built.parameters.take_changed_elements()) {
    const ElementDescriptor& element = built.parameters.elements()[i];
    built.elements[i]->update(built.parameters.values().subspan(element.first_value, element.parameters.size()));
  }
}

void Simulation::Impl::plan_due_sensors(const FrameTime& time) {
  plan.passes.clear();
  due.clear();
  for (std::size_t i = 0; i < built.sensors.size(); ++i) {
    Sensor& sensor = *built.sensors[i].sensor;
    glm::dmat4 world_from_sensor;
    if (!states[i].enabled || !clock.fires(sensor.rate_hz, time.index)) continue;
    if (!pose(built.sensors[i], world_from_sensor)) continue;
    sensor.plan(world_from_sensor, *list, plan);
    due.push_back(i);
  }
}

void Simulation::Impl::collect(const FrameTime& time, std::span<const PassResult> results) {
  measured.clear();
  for (const std::size_t i : due) {
    built.sensors[i].sensor->collect(time, plan, results);
    ++states[i].frames;
    measured.push_back(built.sensors[i].name);
  }
}

/// False where the sensor stands in a part that is switched off.
bool Simulation::Impl::pose(const BuiltSensor& sensor, glm::dmat4& world_from_sensor) const {
  glm::dmat4 world_from_mount;
  if (!flattener.find_mount(*sensor.mount, world_from_mount)) return false;
  if (rigid_mount_frame(world_from_mount, world_from_sensor)) return true;
  throw InputError("sensor \"" + sensor.name +
                   "\" has no direction: what it stands on is scaled to nothing, or is infinitely far away");
}

std::size_t Simulation::Impl::index(std::string_view sensor) const {
  std::vector<std::string_view> known;
  for (std::size_t i = 0; i < built.sensors.size(); ++i) {
    if (built.sensors[i].name == sensor) return i;
    known.push_back(built.sensors[i].name);
  }
  throw InputError("there is no sensor \"" + std::string(sensor) + "\"" + suggestion(sensor, known));
}
