#include "simvis/simulation.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include "effects/shadows.h"
#include "engine/assert.h"
#include "engine/cache_file.h"
#include "engine/device_costs.h"
#include "sensors/scan_calibration.h"
#include "simvis/clock.h"
#include "simvis/live_scene.h"
#include "simvis/mount_frame.h"
#include "simvis/view_layer.h"

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

template <typename Output>
const Output& require(const Output* output, const BuiltSensor& sensor, std::string_view what) {
  if (output != nullptr) return *output;
  throw InputError("sensor \"" + sensor.name + "\", a " + sensor.type + ", gives no " + std::string(what));
}

}  // namespace

struct Simulation::Impl : Observations {
  Impl(const SimulationDesc& desc, std::span<const Command> commands);

  void step();
  void update_elements();
  void show_to_people(const FrameTime& time);
  void plan_due_sensors(ViewLayer& layer, bool visualization, const FrameTime& time);
  void collect(ViewLayer& layer, const FrameTime& time, std::span<const PassResult> results);
  void take_new_sensors();
  ViewLayer& layer_of(const BuiltSensor& sensor) { return sensor.sensor->visualization() ? *people : sensing; }
  bool pose(const BuiltSensor& sensor, glm::dmat4& world_from_sensor);
  std::size_t index(std::string_view sensor) const;
  const BuiltSensor& sensor(std::string_view name) const { return scene.built.sensors[index(name)]; }

  ObservedScan scan(std::string_view name) const override;
  bool find_mount(const Mount& mount, glm::dmat4& world_from_mount) const override;

  struct State {
    bool enabled = true;
    std::uint64_t frames = 0;
    glm::dmat4 world_from_sensor{1.0};  // when it last measured
  };

  const WorkTable& costs();

  Clock clock;
  LiveScene scene;
  std::vector<State> states;  // as long as scene.built.sensors
  std::filesystem::path cache;
  Device device;
  std::optional<WorkTable> device_costs;  // once a sensor has asked
  ViewLayer sensing;
  std::optional<ViewLayer> people;  // while the scene has a visualization sensor
  std::uint64_t next_frame = 0;
  std::vector<std::string> measured;  // names of the sensors that did in this frame
  Stages stages;
};

Simulation::Impl::Impl(const SimulationDesc& desc, std::span<const Command> commands)
    : clock(desc.rate_hz),
      scene(desc.overrides, commands, desc.seed),
      cache(cache_folder(desc.device.cache_dir)),
      device(desc.device),
      sensing(scene.built.scene.root(), Audience::sensors, device) {
  scene.require(device.target_limits());
  take_new_sensors();
}

void Simulation::Impl::take_new_sensors() {
  for (std::size_t i = states.size(); i < scene.built.sensors.size(); ++i) {
    scene.built.sensors[i].sensor->take_costs([this]() -> const WorkTable& { return costs(); });
  }
  states.resize(scene.built.sensors.size());
  const bool wanted = std::ranges::any_of(scene.built.sensors,
                                          [](const BuiltSensor& sensor) { return sensor.sensor->visualization(); });
  if (wanted && !people) people.emplace(scene.built.scene.root(), Audience::people, device);
}

const WorkTable& Simulation::Impl::costs() {
  if (!device_costs) {
    const std::filesystem::path file = device_costs_file(device, cache, version());
    device_costs = load_device_costs(file);
    const std::unique_ptr<RayCaster> rays = make_ray_caster(device);
    if (!device_costs) device_costs = save_device_costs(file, measure_scan_costs(device, *rays));
  }
  return *device_costs;
}

void Simulation::Impl::step() {
  const FrameTime time = clock.frame(next_frame);
  measured.clear();
  stages.clear();
  stages.begin("elements");
  update_elements();
  stages.begin("flatten");
  sensing.list = &sensing.flattener.update();
  stages.begin("plan");
  plan_due_sensors(sensing, false, time);
  stages.begin("render");
  const std::span<const PassResult> results = sensing.renderer.render(*sensing.list, sensing.plan);
  stages.begin("collect");
  collect(sensing, time, results);
  if (people) {
    stages.begin("visualization");
    show_to_people(time);
  }
  stages.end();
  ++next_frame;
}

void Simulation::Impl::show_to_people(const FrameTime& time) {
  bool anybody = false;
  for (std::size_t i = 0; i < states.size(); ++i) {
    anybody |= states[i].enabled && scene.built.sensors[i].sensor->visualization();
  }
  if (!anybody) return;
  people->list = &people->flattener.update();
  for (const std::unique_ptr<Element>& element : scene.built.elements) element->observe(*this);
  people->list = &people->flattener.update();
  plan_due_sensors(*people, true, time);
  collect(*people, time, people->renderer.render(*people->list, people->plan));
}

void Simulation::Impl::update_elements() {
  Parameters& parameters = scene.built.parameters;
  for (const std::size_t i : parameters.take_changed_elements()) {
    const ElementDescriptor& element = parameters.elements()[i];
    scene.built.elements[i]->update(parameters.values().subspan(element.first_value, element.parameters.size()));
  }
}

void Simulation::Impl::plan_due_sensors(ViewLayer& layer, bool visualization, const FrameTime& time) {
  layer.plan.passes.clear();
  layer.plan.casts.clear();
  layer.plan.effects.clear();
  layer.due.clear();
  for (std::size_t i = 0; i < states.size(); ++i) {
    const BuiltSensor& sensor = scene.built.sensors[i];
    if (sensor.sensor->visualization() != visualization) continue;
    if (!states[i].enabled || !clock.fires(sensor.sensor->rate_hz, time.index)) continue;
    if (!pose(sensor, states[i].world_from_sensor)) continue;
    sensor.sensor->plan(states[i].world_from_sensor, *layer.list, layer.plan);
    layer.due.push_back(i);
  }
  plan_shadows(*layer.list, device.target_limits(), layer.plan);
  for (RayCast& cast : layer.plan.casts) cast.engine = layer.caster->engine();
}

void Simulation::Impl::collect(ViewLayer& layer, const FrameTime& time, std::span<const PassResult> results) {
  layer.caster->set_world(*layer.list);
  for (const std::size_t i : layer.due) {
    scene.built.sensors[i].sensor->collect(time, layer.plan, results);
    scene.built.sensors[i].sensor->cast(*layer.caster);
  }
  for (const std::size_t i : layer.due) {
    ++states[i].frames;
    measured.push_back(scene.built.sensors[i].name);
  }
}

/// False where the sensor stands in a part that is switched off.
bool Simulation::Impl::pose(const BuiltSensor& sensor, glm::dmat4& world_from_sensor) {
  glm::dmat4 world_from_mount;
  if (!layer_of(sensor).flattener.find_mount(*sensor.mount, world_from_mount)) return false;
  if (rigid_mount_frame(world_from_mount, world_from_sensor)) return true;
  throw InputError("sensor \"" + sensor.name +
                   "\" has no direction: what it stands on is scaled to nothing, or is infinitely far away");
}

std::size_t Simulation::Impl::index(std::string_view name) const {
  std::vector<std::string_view> known;
  for (std::size_t i = 0; i < scene.built.sensors.size(); ++i) {
    if (scene.built.sensors[i].name == name) return i;
    known.push_back(scene.built.sensors[i].name);
  }
  throw InputError("there is no sensor \"" + std::string(name) + "\"" + suggestion(name, known));
}

ObservedScan Simulation::Impl::scan(std::string_view name) const {
  const std::size_t i = index(name);
  if (states[i].frames == 0) return {};
  return {scene.built.sensors[i].sensor->scan(), states[i].world_from_sensor, states[i].frames};
}

bool Simulation::Impl::find_mount(const Mount& mount, glm::dmat4& world_from_mount) const {
  return people->flattener.find_mount(mount, world_from_mount);
}

Simulation::Simulation(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;
Simulation::~Simulation() = default;

Simulation Simulation::load(const std::filesystem::path& scene, const SimulationDesc& desc) {
  return Simulation(std::make_unique<Impl>(desc, read_commands(scene)));
}

Simulation Simulation::from_string(std::string_view xml, const SimulationDesc& desc,
                                   const std::filesystem::path& folder, const std::string& name) {
  return Simulation(std::make_unique<Impl>(desc, parse_commands(xml, name, folder)));
}

void Simulation::set(std::string_view element, std::string_view parameter, double value) {
  Parameters& parameters = impl_->scene.built.parameters;
  parameters.set(parameters.index(element, parameter), value);
}

double Simulation::get(std::string_view element, std::string_view parameter) const {
  const Parameters& parameters = impl_->scene.built.parameters;
  return parameters.values()[parameters.index(element, parameter)];
}

void Simulation::execute(std::string_view xml, const std::filesystem::path& folder, const std::string& name) {
  impl_->scene.built.parameters.log_request(std::string(xml));
  impl_->scene.execute(parse_commands(xml, name, folder));
  impl_->take_new_sensors();
}

const Command& Simulation::command(std::string_view sensor) const { return impl_->sensor(sensor).command; }

void Simulation::add_variant(std::string_view sensor, const Command& command) {
  impl_->scene.add_variant(impl_->index(sensor), command);
  impl_->take_new_sensors();
}

void Simulation::enable(std::string_view sensor, bool on) { impl_->states[impl_->index(sensor)].enabled = on; }

void Simulation::step() { impl_->step(); }

FrameTime Simulation::next_frame() const { return impl_->clock.frame(impl_->next_frame); }

const Scan& Simulation::scan(std::string_view sensor) const {
  const BuiltSensor& found = impl_->sensor(sensor);
  return require(found.sensor->scan(), found, "scan");
}

const Image& Simulation::color(std::string_view sensor) const {
  const BuiltSensor& found = impl_->sensor(sensor);
  return require(found.sensor->color(), found, "colour");
}

const Image& Simulation::depth(std::string_view sensor) const {
  const BuiltSensor& found = impl_->sensor(sensor);
  return require(found.sensor->depth(), found, "depth");
}

const Image& Simulation::picture(std::string_view sensor, std::string_view name) const {
  const BuiltSensor& found = impl_->sensor(sensor);
  return require(found.sensor->picture(name), found, "picture \"" + std::string(name) + "\"");
}

double Simulation::value(std::string_view sensor, std::string_view name) const {
  const std::optional<double> value = find_value(sensor, name);
  return require(value ? &*value : nullptr, impl_->sensor(sensor), "value \"" + std::string(name) + "\"");
}

std::optional<double> Simulation::find_value(std::string_view sensor, std::string_view name) const {
  for (const NamedValue& value : impl_->sensor(sensor).sensor->values()) {
    if (value.name == name) return value.value;
  }
  return {};
}

std::optional<double> SensorInfo::number(std::string_view note) const {
  const auto found = std::ranges::find(report.notes, note, &SensorNote::name);
  const double* const value = found == report.notes.end() ? nullptr : std::get_if<double>(&found->value);
  return value == nullptr ? std::nullopt : std::optional(*value);
}

Parameters& Simulation::parameters() { return impl_->scene.built.parameters; }
const Parameters& Simulation::parameters() const { return impl_->scene.built.parameters; }

bool Simulation::sensor_pose(std::string_view sensor, glm::dmat4& world_from_sensor) const {
  return impl_->pose(impl_->sensor(sensor), world_from_sensor);
}

std::vector<SensorInfo> Simulation::sensors() const {
  std::vector<SensorInfo> infos;
  for (std::size_t i = 0; i < impl_->scene.built.sensors.size(); ++i) {
    const BuiltSensor& sensor = impl_->scene.built.sensors[i];
    infos.push_back({sensor.name,
                     sensor.type,
                     sensor.sensor->method(),
                     impl_->states[i].frames,
                     impl_->states[i].enabled,
                     sensor.sensor->report(),
                     {}});
  }
  return infos;
}

std::span<const std::string> Simulation::measured() const { return impl_->measured; }

void Simulation::write(std::string_view sensor, OutputSink& sink) const { impl_->sensor(sensor).sensor->write(sink); }

const std::vector<std::string>& Simulation::warnings() const { return impl_->scene.built.scene.warnings(); }
const DeviceInfo& Simulation::device() const { return impl_->device.info(); }
const FrameCounters& Simulation::counters() const { return impl_->sensing.renderer.counters(); }
RayCounters Simulation::ray_counters() const { return impl_->sensing.caster->counters(); }
const DrawList& Simulation::draw_list() const { return *impl_->sensing.list; }
const FramePlan& Simulation::frame_plan() const { return impl_->sensing.plan; }

const FramePlan* Simulation::visualization_plan() const { return impl_->people ? &impl_->people->plan : nullptr; }

const FrameCounters* Simulation::visualization_counters() const {
  return impl_->people ? &impl_->people->renderer.counters() : nullptr;
}

std::span<const StageTime> Simulation::stages() const { return impl_->stages.times(); }
std::uint64_t Simulation::validation_messages() const { return impl_->device.validation_messages(); }

std::string_view version() { return SIMVIS_VERSION; }

}  // namespace simvis
