#include <simvis/simulation.h>

#include <algorithm>
#include <exception>
#include <optional>
#include <utility>

#include <simvis/cost_model.h>
#include <simvis/effect.h>
#include "effects/scene/shadows.h"
#include "engine/base/assert.h"
#include "engine/base/cache_file.h"
#include "sensors/laser_scanner/scan_calibration.h"
#include "simvis/clock.h"
#include "simvis/live_scene.h"
#include "simvis/mount_frame.h"
#include "simvis/step_stages.h"
#include "simvis/view_layer.h"

namespace simvis {

namespace {

std::size_t count_views(const FramePlan& plan) {
  std::size_t views = 0;
  for (const Pass& pass : plan.passes) views += pass.views.size();
  return views;
}

template <typename Output>
const Output& require(const Output* output, const BuiltSensor& sensor, std::string_view what) {
  if (output != nullptr) return *output;
  throw InputError("sensor \"" + sensor.name + "\", a " + sensor.type + ", gives no " + std::string(what));
}

// The device reports to whom the simulation reports to.
DeviceDesc device_desc(const SimulationDesc& desc) {
  DeviceDesc device = desc.device;
  if (desc.progress) device.progress = desc.progress;
  return device;
}

}  // namespace

struct Simulation::Impl : Observations {
  Impl(const SimulationDesc& desc, std::span<const Command> commands);

  void start();
  void finish();
  void skip_frame();
  void require_skippable() const;
  Impl& idle();
  void update_elements();
  void show_to_people(const FrameTime& time);
  void plan_due_sensors(ViewLayer& layer, bool visualization, const FrameTime& time);
  void render(ViewLayer& layer, const FrameTime& time);
  void measure(ViewLayer& layer, const FrameTime& time, std::span<const PassResult> results);
  void measure(ViewLayer& layer, ViewLayer::Entry& entry, const FrameTime& time, std::span<const PassResult> results);
  DueState due_state(std::size_t sensor, const FrameTime& time);
  void add_new_sensors();
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
    std::vector<std::string> effects;   // that it has had
  };

  const CostModel& costs();

  Clock clock;
  LiveScene scene;
  std::vector<State> states;  // as long as scene.built.sensors
  std::filesystem::path cache;
  Device device;
  std::optional<CostModel> device_costs;  // once a sensor has asked
  ViewLayer sensing;
  std::optional<ViewLayer> people;    // while the scene has a visualization sensor
  std::uint64_t next_frame = 0;       // that is not under way
  bool under_way = false;             // the frame before it, and the device may be at work
  std::vector<std::string> measured;  // names of the sensors that did in this frame
  StepStages stages;
  bool instrumented;
  std::vector<SensorCost> sensor_costs;
};

Simulation::Impl::Impl(const SimulationDesc& desc, std::span<const Command> commands)
    : clock(desc.rate_hz),
      scene(desc.overrides, commands, desc.seed, desc.progress),
      cache(cache_folder(desc.device.cache_dir)),
      device(device_desc(desc)),
      sensing(scene.built.scene.root(), Audience::sensors, device),
      instrumented(desc.device.instrumented) {
  scene.require(device.target_limits());
  add_new_sensors();
}

void Simulation::Impl::add_new_sensors() {
  for (std::size_t i = states.size(); i < scene.built.sensors.size(); ++i) {
    scene.built.sensors[i].sensor->use_cost_model([this]() -> const CostModel& { return costs(); });
  }
  states.resize(scene.built.sensors.size());
  const bool wanted = std::ranges::any_of(scene.built.sensors,
                                          [](const BuiltSensor& sensor) { return sensor.sensor->visualization(); });
  if (wanted && !people) people.emplace(scene.built.scene.root(), Audience::people, device);
}

const CostModel& Simulation::Impl::costs() {
  if (!device_costs) {
    const std::filesystem::path file = cost_model_file(device, cache, version());
    device_costs = load_cost_model(file);
    const std::unique_ptr<RayCaster> rays = make_ray_caster(device);
    if (!device_costs) device_costs = save_cost_model(file, measure_scan_costs(device, *rays));
  }
  return *device_costs;
}

void Simulation::Impl::start() {
  const FrameTime time = clock.frame(next_frame);
  stages.clear();
  stages.begin("elements");
  update_elements();
  stages.begin("flatten");
  sensing.list = &sensing.flattener.update();
  stages.begin("plan");
  plan_due_sensors(sensing, false, time);
  stages.begin("render");
  sensing.renderer.submit(*sensing.list, sensing.plan);
  ++next_frame;
  under_way = true;
}

void Simulation::Impl::finish() {
  if (!under_way) return;
  under_way = false;
  const FrameTime time = clock.frame(--next_frame);
  measured.clear();
  sensor_costs.clear();
  render(sensing, time);
  if (people) {
    stages.begin("visualization");
    show_to_people(time);
  }
  stages.end();
  ++next_frame;
}

// What casts every beam, on the host, does so while the device draws what the others need.
void Simulation::Impl::render(ViewLayer& layer, const FrameTime& time) {
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

// Nothing is measured, so only where sensors stand has to be worked out.
void Simulation::Impl::skip_frame() {
  require_skippable();
  const FrameTime time = clock.frame(next_frame);
  bool looked_back_at = false;
  for (std::size_t i = 0; i < states.size(); ++i) {
    looked_back_at |=
        states[i].enabled && scene.built.sensors[i].sensor->history_dependence() != HistoryDependence::none;
  }
  if (looked_back_at) {
    update_elements();
    sensing.list = &sensing.flattener.update();
    for (std::size_t i = 0; i < states.size(); ++i) {
      if (due_state(i, time) != DueState::due) continue;
      scene.built.sensors[i].sensor->skip_frame(time, states[i].world_from_sensor);
    }
  }
  ++next_frame;
}

void Simulation::Impl::require_skippable() const {
  for (std::size_t i = 0; i < states.size(); ++i) {
    const BuiltSensor& built = scene.built.sensors[i];
    if (!states[i].enabled || built.sensor->history_dependence() != HistoryDependence::measurements) continue;
    throw InputError("sensor \"" + built.name + "\", a " + built.type + " (" + built.sensor->method() +
                     "), depends on what was measured in the frames before, so none can be passed over; expected " +
                     (built.sensor->visualization() ? "it to be off" : "another method"));
  }
}

Simulation::Impl& Simulation::Impl::idle() {
  if (under_way) throw InputError("a frame is under way, expected finish() before this");
  return *this;
}

void Simulation::Impl::show_to_people(const FrameTime& time) {
  bool anybody = false;
  for (std::size_t i = 0; i < states.size(); ++i) {
    anybody |= states[i].enabled && scene.built.sensors[i].sensor->visualization();
  }
  if (anybody) {
    people->list = &people->flattener.update();
    for (const std::unique_ptr<Element>& element : scene.built.elements) element->observe(*this);
    people->list = &people->flattener.update();
  }
  plan_due_sensors(*people, true, time);
  people->renderer.submit(*people->list, people->plan);
  render(*people, time);
}

void Simulation::Impl::update_elements() {
  Parameters& parameters = scene.built.parameters;
  for (const std::size_t i : parameters.drain_changed_elements()) {
    const ElementDescriptor& element = parameters.elements()[i];
    scene.built.elements[i]->update(parameters.values().subspan(element.first_value, element.parameters.size()));
  }
}

void Simulation::Impl::plan_due_sensors(ViewLayer& layer, bool visualization, const FrameTime& time) {
  layer.begin_plan();
  FramePlan& plan = layer.plan;
  for (std::size_t i = 0; i < states.size(); ++i) {
    Sensor& sensor = *scene.built.sensors[i].sensor;
    if (sensor.visualization() != visualization) continue;
    ViewLayer::Entry entry{.sensor = i,
                           .due_state = due_state(i, time),
                           .first_pass = plan.passes.size(),
                           .first_cast = plan.casts.size()};
    if (entry.due_state == DueState::due) {
      const std::size_t views = count_views(plan);
      sensor.begin(time);
      sensor.plan(states[i].world_from_sensor, *layer.list, plan);
      entry.draws = count_views(plan) > views;
    }
    entry.end_pass = plan.passes.size();
    entry.end_cast = plan.casts.size();
    layer.entries.push_back(entry);
    plan_scene_effects(scene.built.sensors[i].name, entry.first_pass, *layer.list, plan);
  }
  plan_shadows(*layer.list, device.target_limits(), plan);
  for (RayCast& cast : plan.casts) cast.engine = layer.caster->engine();
  for (const PlannedEffect& planned : plan.effects) {
    std::vector<std::string>& effects = states[index(planned.sensor)].effects;
    if (std::ranges::find(effects, planned.effect) == effects.end()) effects.push_back(planned.effect);
  }
}

// Of a sensor that is due, its pose is known then.
DueState Simulation::Impl::due_state(std::size_t sensor, const FrameTime& time) {
  const BuiltSensor& built = scene.built.sensors[sensor];
  if (!states[sensor].enabled) return DueState::off;
  if (!clock.fires(built.sensor->rate_hz, time.index)) return DueState::waiting;
  return pose(built, states[sensor].world_from_sensor) ? DueState::due : DueState::hidden;
}

void Simulation::Impl::measure(ViewLayer& layer, const FrameTime& time, std::span<const PassResult> results) {
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
}

void Simulation::Impl::measure(ViewLayer& layer, ViewLayer::Entry& entry, const FrameTime& time,
                               std::span<const PassResult> results) {
  const BuiltSensor& sensor = scene.built.sensors[entry.sensor];
  entry.taken = true;
  if (!instrumented) {
    sensor.sensor->collect(time, layer.plan, results);
    sensor.sensor->cast(*layer.caster);
    return;
  }
  const RayCounters before = layer.caster->counters();
  entry.cost = {.sensor = sensor.name, .start_ns = StepStages::now_ns()};
  sensor.sensor->collect(time, layer.plan, results);
  entry.cost.collected_ns = StepStages::now_ns();
  sensor.sensor->cast(*layer.caster);
  entry.cost.end_ns = StepStages::now_ns();
  const RayCounters after = layer.caster->counters();
  entry.cost.rays = after.rays - before.rays;
  entry.cost.item_tests = after.item_tests - before.item_tests;
  entry.cost.triangle_tests = after.triangle_tests - before.triangle_tests;
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
  impl_->idle().scene.built.parameters.log_request(std::string(xml));
  impl_->scene.execute(parse_commands(xml, name, folder));
  impl_->add_new_sensors();
}

const Command& Simulation::command(std::string_view sensor) const { return impl_->sensor(sensor).command; }

void Simulation::add_variant(std::string_view sensor, const Command& command) {
  impl_->idle().scene.add_variant(impl_->index(sensor), command);
  impl_->add_new_sensors();
}

void Simulation::enable(std::string_view sensor, bool on) { impl_->idle().states[impl_->index(sensor)].enabled = on; }

void Simulation::step() {
  finish();
  impl_->measured.clear();
  impl_->start();
  finish();
}

void Simulation::step_async() {
  finish();
  impl_->start();
}

void Simulation::finish() { impl_->finish(); }
void Simulation::skip_frame() { impl_->idle().skip_frame(); }
void Simulation::require_skippable() const { impl_->require_skippable(); }

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
  for (const NamedValue& value : impl_->idle().sensor(sensor).sensor->values()) {
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
  return impl_->idle().pose(impl_->sensor(sensor), world_from_sensor);
}

std::vector<SensorInfo> Simulation::sensors() const {
  std::vector<SensorInfo> infos;
  impl_->idle();
  for (std::size_t i = 0; i < impl_->scene.built.sensors.size(); ++i) {
    const BuiltSensor& sensor = impl_->scene.built.sensors[i];
    infos.push_back({sensor.name,
                     sensor.type,
                     sensor.sensor->method(),
                     impl_->states[i].frames,
                     impl_->states[i].enabled,
                     sensor.sensor->report(),
                     {},
                     impl_->states[i].effects});
  }
  return infos;
}

std::span<const std::string> Simulation::measured() const { return impl_->measured; }

void Simulation::write(std::string_view sensor, OutputSink& sink) const { impl_->sensor(sensor).sensor->write(sink); }

const std::vector<std::string>& Simulation::warnings() const { return impl_->scene.built.scene.warnings(); }
const DeviceInfo& Simulation::device() const { return impl_->device.info(); }
const FrameCounters& Simulation::counters() const { return impl_->idle().sensing.renderer.counters(); }
RayCounters Simulation::ray_counters() const { return impl_->idle().sensing.caster->counters(); }
const DrawList& Simulation::draw_list() const { return *impl_->idle().sensing.list; }
const FramePlan& Simulation::frame_plan() const {
  return impl_->idle().sensing.complete_plan(impl_->scene.built.sensors);
}
const FrameCosts* Simulation::frame_costs() const { return impl_->idle().sensing.renderer.costs(); }

const FramePlan* Simulation::visualization_plan() const {
  return impl_->idle().people ? &impl_->people->complete_plan(impl_->scene.built.sensors) : nullptr;
}

const FrameCounters* Simulation::visualization_counters() const {
  return impl_->idle().people ? &impl_->people->renderer.counters() : nullptr;
}

const FrameCosts* Simulation::visualization_costs() const {
  return impl_->idle().people ? impl_->people->renderer.costs() : nullptr;
}

std::span<const SensorCost> Simulation::sensor_costs() const { return impl_->idle().sensor_costs; }
std::uint64_t Simulation::device_memory_bytes() const { return impl_->idle().device.memory_bytes(); }
std::span<const StageTime> Simulation::stages() const { return impl_->idle().stages.times(); }
std::uint64_t Simulation::validation_messages() const { return impl_->device.validation_messages(); }

std::string_view version() { return SIMVIS_VERSION; }

}  // namespace simvis
