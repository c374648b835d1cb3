#include "simvis/simulation.h"

#include <algorithm>
#include <chrono>
#include <unordered_set>
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

template <typename Output>
const Output& require(const Output* output, const BuiltSensor& sensor, std::string_view what) {
  if (output != nullptr) return *output;
  throw InputError("sensor \"" + sensor.name + "\", a " + sensor.type + ", gives no " + std::string(what));
}

/// An illegal override is an error whether or not the scene has a sensor of the type.
void check_overrides(std::span<const AttributeOverride> overrides) {
  for (const AttributeOverride& each : overrides) {
    const SensorType* const type = find_sensor_type(each.sensor_type);
    if (type == nullptr) continue;  // the builder says what there is
    const Location where{.file = each.origin.empty() ? each.sensor_type + "." + each.attribute : each.origin};
    const Command command{
        .kind = CommandKind::sensor, .attributes = {{each.attribute, each.value, where}}, .where = where, .folder = {}};
    AttributeValues checked(command, type->attributes, {});
  }
}

BuiltScene build(std::span<const Command> commands, const SimulationDesc& desc) {
  check_overrides(desc.overrides);
  BuiltScene built = build_scene(commands, desc.overrides, desc.seed);
  // Before everything else, where no transform is in force.
  const GroupPtr& root = built.scene.root();
  if (!has_light(root)) root->insert_before(*root->children().front(), std::make_shared<LightNode>(kDefaultLight));
  return built;
}

}  // namespace

struct Simulation::Impl {
  Impl(const Clock& frame_clock, BuiltScene scene, const DeviceDesc& device_desc);

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

Simulation::Impl::Impl(const Clock& frame_clock, BuiltScene scene, const DeviceDesc& device_desc)
    : clock(frame_clock),
      built(std::move(scene)),
      states(built.sensors.size()),
      device(device_desc),
      renderer(device),
      flattener(built.scene.root()),
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

Simulation::Simulation(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;
Simulation::~Simulation() = default;

Simulation Simulation::load(const std::filesystem::path& scene, const SimulationDesc& desc) {
  const Clock clock(desc.rate_hz);
  return Simulation(std::make_unique<Impl>(clock, build(read_commands(scene), desc), desc.device));
}

Simulation Simulation::from_string(std::string_view xml, const SimulationDesc& desc,
                                   const std::filesystem::path& folder, const std::string& name) {
  const Clock clock(desc.rate_hz);
  return Simulation(std::make_unique<Impl>(clock, build(parse_commands(xml, name, folder), desc), desc.device));
}

void Simulation::set(std::string_view element, std::string_view parameter, double value) {
  Parameters& parameters = impl_->built.parameters;
  parameters.set(parameters.index(element, parameter), value);
}

double Simulation::get(std::string_view element, std::string_view parameter) const {
  const Parameters& parameters = impl_->built.parameters;
  return parameters.values()[parameters.index(element, parameter)];
}

void Simulation::enable(std::string_view sensor, bool on) { impl_->states[impl_->index(sensor)].enabled = on; }

void Simulation::step() { impl_->step(); }

FrameTime Simulation::next_frame() const { return impl_->clock.frame(impl_->next_frame); }

const Scan& Simulation::scan(std::string_view sensor) const {
  const BuiltSensor& found = impl_->built.sensors[impl_->index(sensor)];
  return require(found.sensor->scan(), found, "scan");
}

const Image& Simulation::color(std::string_view sensor) const {
  const BuiltSensor& found = impl_->built.sensors[impl_->index(sensor)];
  return require(found.sensor->color(), found, "colour");
}

const Image& Simulation::depth(std::string_view sensor) const {
  const BuiltSensor& found = impl_->built.sensors[impl_->index(sensor)];
  return require(found.sensor->depth(), found, "depth");
}

const Image& Simulation::picture(std::string_view sensor, std::string_view name) const {
  const BuiltSensor& found = impl_->built.sensors[impl_->index(sensor)];
  return require(found.sensor->picture(name), found, "picture \"" + std::string(name) + "\"");
}

double Simulation::value(std::string_view sensor, std::string_view name) const {
  const BuiltSensor& found = impl_->built.sensors[impl_->index(sensor)];
  const std::span<const NamedValue> values = found.sensor->values();
  const auto value = std::ranges::find(values, name, &NamedValue::name);
  return require(value == values.end() ? nullptr : &*value, found, "value \"" + std::string(name) + "\"").value;
}

Parameters& Simulation::parameters() { return impl_->built.parameters; }
const Parameters& Simulation::parameters() const { return impl_->built.parameters; }

bool Simulation::sensor_pose(std::string_view sensor, glm::dmat4& world_from_sensor) const {
  return impl_->pose(impl_->built.sensors[impl_->index(sensor)], world_from_sensor);
}

std::vector<SensorInfo> Simulation::sensors() const {
  std::vector<SensorInfo> infos;
  for (std::size_t i = 0; i < impl_->built.sensors.size(); ++i) {
    const BuiltSensor& sensor = impl_->built.sensors[i];
    infos.push_back(
        {sensor.name, sensor.type, sensor.sensor->method(), impl_->states[i].frames, impl_->states[i].enabled});
  }
  return infos;
}

std::span<const std::string> Simulation::measured() const { return impl_->measured; }

void Simulation::write(std::string_view sensor, OutputSink& sink) const {
  impl_->built.sensors[impl_->index(sensor)].sensor->write(sink);
}

const std::vector<std::string>& Simulation::warnings() const { return impl_->built.scene.warnings(); }
const DeviceInfo& Simulation::device() const { return impl_->device.info(); }
const FrameCounters& Simulation::counters() const { return impl_->renderer.counters(); }
const DrawList& Simulation::draw_list() const { return *impl_->list; }
const FramePlan& Simulation::frame_plan() const { return impl_->plan; }
std::span<const StageTime> Simulation::stages() const { return impl_->stages.times(); }
std::uint64_t Simulation::validation_messages() const { return impl_->device.validation_messages(); }

std::string_view version() { return SIMVIS_VERSION; }

}  // namespace simvis
