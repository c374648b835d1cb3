#include <simvis/simulation.h>

#include <algorithm>
#include <utility>

#include "simvis/simulation_impl.h"

namespace simvis {

namespace {

template <typename Output>
const Output& require(const Output* output, const BuiltSensor& sensor, std::string_view what) {
  if (output != nullptr) return *output;
  throw InputError("sensor \"" + sensor.name + "\", a " + sensor.type + ", has no " + std::string(what));
}

}  // namespace

Simulation::Simulation(std::unique_ptr<SimulationImpl> impl) : impl_(std::move(impl)) {}
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;
Simulation::~Simulation() = default;

Simulation Simulation::load(const std::filesystem::path& scene, const SimulationDesc& desc) {
  const InputLog inputs;
  auto impl = std::make_unique<SimulationImpl>(desc, read_commands(scene));
  impl->add_inputs(inputs);
  return Simulation(std::move(impl));
}

Simulation Simulation::from_string(std::string_view xml, const SimulationDesc& desc,
                                   const std::filesystem::path& folder, const std::string& name) {
  const InputLog inputs;
  auto impl = std::make_unique<SimulationImpl>(desc, parse_commands(xml, name, folder));
  impl->add_inputs(inputs);
  return Simulation(std::move(impl));
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
  const InputLog inputs;
  impl_->scene.execute(parse_commands(xml, name, folder));
  impl_->add_inputs(inputs);
  impl_->add_new_sensors();
}

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

Parameters& Simulation::parameters() { return impl_->scene.built.parameters; }
const Parameters& Simulation::parameters() const { return impl_->scene.built.parameters; }

bool Simulation::sensor_pose(std::string_view sensor, glm::dmat4& world_from_sensor) const {
  return impl_->idle().pose(impl_->sensor(sensor), world_from_sensor);
}

void Simulation::track_part(std::string_view part) { impl_->idle().track_part(part); }

bool Simulation::part_pose(std::string_view part, glm::dmat4& world_from_part) const {
  return impl_->idle().part_pose(part, world_from_part);
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
                     impl_->states[i].effects,
                     find_sensor_type(sensor.type)->capabilities});
  }
  return infos;
}

std::span<const std::string> Simulation::measured() const { return impl_->measured; }

void Simulation::write(std::string_view sensor, OutputSink& sink) const { impl_->sensor(sensor).sensor->write(sink); }

const std::vector<std::string>& Simulation::warnings() const { return impl_->scene.built.scene.warnings(); }
Diagnostics Simulation::diagnostics() const { return Diagnostics(*impl_); }

}  // namespace simvis
