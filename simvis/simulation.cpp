#include <simvis/simulation.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include <simvis/part_importer.h>
#include <simvis/pose.h>
#include "engine/base/stack_limit.h"
#include "engine/vulkan/device_impl.h"
#include "engine/vulkan/sharing/open_devices.h"
#include "simvis/built_scene.h"
#include "simvis/sharing/network.h"
#include "simvis/sharing/packet_recording.h"
#include "simvis/sharing/packet_stream.h"
#include "simvis/sharing/recording.h"
#include "simvis/sharing/serving.h"
#include "simvis/simulation_use.h"

namespace simvis {

namespace {

constexpr double kRigidTolerance = 1e-6;  // of unit vectors: far above float32's rounding, far below any scale meant

// A part file given as the scene is a common mistake, and its content would only be reported as malformed XML.
std::vector<Command> read_scene(const std::filesystem::path& file) {
  if (file.extension() != ".xml" && find_part_importer(file) != nullptr) {
    throw InputError(file.string() +
                     ": error: this is the file of a part, expected a scene; put it into one: <part file=" +
                     in_quotes(file.filename().string()) + " name=\"PART\" insert_at=\"ROOT\"/>");
  }
  return read_commands(file);
}

template <typename Output>
const Output& require(const Output* output, const BuiltSensor& sensor, std::string_view what) {
  if (output != nullptr) return *output;
  throw InputError("sensor \"" + sensor.name + "\", a " + sensor.type + ", has no " + std::string(what));
}

// The first image of a sensor that is wanted.
template <typename Wanted>
Image require_image(SimulationImpl& simulation, std::string_view sensor, std::string_view what, const Wanted& wanted) {
  for (const MeasuredArray& each : simulation.measurement(sensor).arrays) {
    if (!wanted(each)) continue;
    if (std::optional<Image> image = to_image(each)) return *std::move(image);
  }
  return require<Image>(nullptr, simulation.sensor(sensor), what);
}

// A forked process has none of the threads that would have to end, so it leaves the simulation as it is.
void end_simulation(std::unique_ptr<SimulationImpl> impl) {
  if (impl != nullptr && impl->process.forked()) static_cast<void>(impl.release());
}

/// The report of a sensor; with a reading also its columns and their units: "range_m m, echo".
SensorReport report_of(const Sensor& sensor) {
  SensorReport report = sensor.report();
  const Reading* const reading = sensor.reading();
  if (reading == nullptr) return report;
  std::string columns;
  for (const MeasuredArray& column : reading->arrays) {
    columns += (columns.empty() ? "" : ", ") + column.name + (column.unit.empty() ? "" : " ") + column.unit;
  }
  report.notes.push_back({"columns", columns});
  return report;
}

}  // namespace

Simulation::Simulation(std::unique_ptr<SimulationImpl> impl) : impl_(std::move(impl)) {}
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&& other) noexcept {
  end_simulation(std::exchange(impl_, std::move(other.impl_)));
  return *this;
}

Simulation::~Simulation() { end_simulation(std::move(impl_)); }

Simulation Simulation::load(const std::filesystem::path& scene, const SimulationDesc& desc) {
  const ProcessUse process;
  require_stack();
  const InputLog inputs;
  const std::vector<Command> commands = read_scene(scene);
  const DeviceOpening opening(choice_of(desc.device));  // while parts are read, which takes about as long
  auto impl = std::make_unique<SimulationImpl>(desc, commands, scene.string());
  impl->add_inputs(inputs);
  return Simulation(std::move(impl));
}

Simulation Simulation::from_string(std::string_view xml, const SimulationDesc& desc,
                                   const std::filesystem::path& folder, const std::string& name) {
  const ProcessUse process;
  require_stack();
  const InputLog inputs;
  auto impl = std::make_unique<SimulationImpl>(desc, parse_commands(xml, name, folder), name);
  impl->add_inputs(inputs);
  return Simulation(std::move(impl));
}

SimulationUse Simulation::impl() const { return SimulationUse(impl_.get()); }

void Simulation::set(std::string_view element, std::string_view parameter, double value) {
  const SimulationUse use = impl();
  Parameters& parameters = use->scene.built.parameters;
  parameters.set(parameters.index(element, parameter), value);
}

void Simulation::set_pose(std::string_view element, const glm::dmat4& parent_from_child) {
  const SimulationUse use = impl();
  Parameters& parameters = use->scene.built.parameters;
  const auto found = std::ranges::find_if(
      parameters.elements(), [&](const ElementDescriptor& each) { return !each.removed && each.name == element; });
  if (found == parameters.elements().end()) parameters.index(element, "x");  // throws
  if (found->type != "pose") {
    throw InputError("element " + in_quotes(element) + " is a " + found->type + ", expected an element of type pose");
  }
  if (!is_rigid(parent_from_child, kRigidTolerance)) {
    throw InputError(found->name + ": the matrix is not rigid, expected a rotation and a translation");
  }
  const Pose pose = to_pose(parent_from_child);
  const glm::dvec3& p = pose.position_m;
  const double values[] = {
      p.x, p.y, p.z, glm::degrees(pose.roll_rad), glm::degrees(pose.pitch_rad), glm::degrees(pose.yaw_rad)};
  for (std::size_t i = 0; i < std::size(values); ++i) {
    const std::string wrong = check_number(found->parameters[i], values[i]);
    if (!wrong.empty()) throw InputError(parameters.name(found->first_value + i) + ": " + wrong);
  }
  for (std::size_t i = 0; i < std::size(values); ++i) parameters.set(found->first_value + i, values[i]);
}

void Simulation::set_pose(std::string_view element, const glm::dvec3& position_m, const glm::dquat& rotation) {
  if (!(std::abs(glm::length(rotation) - 1) <= kRigidTolerance)) {
    throw InputError(std::string(element) + ": the quaternion has length " + format_number(glm::length(rotation)) +
                     ", expected 1");
  }
  glm::dmat4 parent_from_child = glm::mat4_cast(glm::normalize(rotation));
  parent_from_child[3] = glm::dvec4(position_m, 1);
  set_pose(element, parent_from_child);
}

double Simulation::get(std::string_view element, std::string_view parameter) const {
  const SimulationUse use = impl();
  const Parameters& parameters = use->scene.built.parameters;
  return parameters.values()[parameters.index(element, parameter)];
}

void Simulation::execute(std::string_view xml, const std::filesystem::path& folder, const std::string& name) {
  const SimulationUse use = impl();
  use->idle().measure_skipped();
  use->scene.built.parameters.log_request(std::string(xml));
  const InputLog inputs;
  use->scene.execute(parse_commands(xml, name, folder));
  use->add_inputs(inputs);
  use->follow_scene();
}

void Simulation::serve(const ServeDesc& desc) {
  const SimulationUse use = impl();
  SimulationImpl& idle = use->idle();
  if (idle.outlets.find<Serving>()) {
    throw InputError("the simulation is served already, expected one call of serve()");
  }
  idle.outlets.add(std::make_unique<Serving>(desc, idle.scene.built));
  if (Network* const network = idle.outlets.find<Network>()) network->serve_as(desc.name);
}

void Simulation::record(const RecordDesc& desc) {
  const SimulationUse use = impl();
  SimulationImpl& idle = use->idle();
  if (idle.outlets.find<Recording>()) {
    throw InputError("the simulation is recorded already, expected finish_recording() before");
  }
  idle.outlets.add(std::make_unique<Recording>(desc, idle.scene.built));
}

RecordReport Simulation::finish_recording() {
  const SimulationUse use = impl();
  const std::unique_ptr<Recording> recording = use->idle().outlets.remove<Recording>();
  if (!recording) throw InputError("the simulation is not recorded, expected record() before");
  return recording->finish();
}

void Simulation::record_packets(const PacketRecordDesc& desc) {
  const SimulationUse use = impl();
  SimulationImpl& idle = use->idle();
  if (idle.outlets.find<PacketRecording>()) {
    throw InputError("packets are recorded already, expected finish_packet_recording() before");
  }
  idle.outlets.add(std::make_unique<PacketRecording>(desc, idle.scene.built));
}

PacketReport Simulation::finish_packet_recording() {
  const SimulationUse use = impl();
  const auto recording = use->idle().outlets.remove<PacketRecording>();
  if (!recording) throw InputError("no packets are recorded, expected record_packets() before");
  return recording->finish();
}

void Simulation::send_packets(const PacketStreamDesc& desc) {
  const SimulationUse use = impl();
  SimulationImpl& idle = use->idle();
  if (idle.outlets.find<PacketStream>()) {
    throw InputError("packets are sent already, expected stop_packets() before");
  }
  idle.outlets.add(std::make_unique<PacketStream>(desc, idle.scene.built));
}

PacketReport Simulation::stop_packets() {
  const SimulationUse use = impl();
  const auto stream = use->idle().outlets.remove<PacketStream>();
  if (!stream) throw InputError("no packets are sent, expected send_packets() before");
  return stream->finish();
}

DdsReach Simulation::join_dds(const DdsDesc& desc) {
  const SimulationUse use = impl();
  SimulationImpl& idle = use->idle();
  if (idle.outlets.find<Network>()) {
    throw InputError("the simulation takes part in DDS already, expected leave_dds() before");
  }
  auto network = std::make_unique<Network>(desc, idle.scene.built);
  if (const Serving* const serving = idle.outlets.find<Serving>()) network->serve_as(serving->served_name());
  DdsReach reach = network->reach();
  idle.outlets.add(std::move(network));
  return reach;
}

DdsReport Simulation::leave_dds() {
  const SimulationUse use = impl();
  const std::unique_ptr<Network> network = use->idle().outlets.remove<Network>();
  if (!network) throw InputError("the simulation does not take part in DDS, expected join_dds() before");
  return network->finish();
}

void Simulation::show_scan(std::string_view sensor, Scan scan) {
  const SimulationUse use = impl();
  const BuiltSensor& found = use->idle().sensor(sensor);
  SimulationImpl::ShownScan& shown = use->shown_scans[found.id];
  shown.scan = std::move(scan);
  ++shown.count;
}

void Simulation::add_variant(std::string_view sensor, const Command& command) {
  const SimulationUse use = impl();
  use->idle().measure_skipped();
  use->scene.add_variant(use->index(sensor), command);
  use->follow_scene();
}

void Simulation::enable(std::string_view sensor, bool on) {
  const SimulationUse use = impl();
  SimulationImpl::State& state = use->idle().states[use->index(sensor)];
  if (state.enabled == on) return;
  state.enabled = on;
  use->sensed.enable(state.sensor, on);
}

void Simulation::step() { impl()->step(); }
void Simulation::step(std::chrono::nanoseconds dt) { impl()->step(dt); }

void Simulation::step_async() {
  const SimulationUse use = impl();
  use->finish();
  use->start();
}

void Simulation::finish() { impl()->finish(); }
void Simulation::skip_frame() { impl()->idle().skip_frame(); }
void Simulation::require_skippable() const { impl()->require_skippable(); }

FrameTime Simulation::next_frame() const { return impl()->next_frame(); }
std::optional<FrameTime> Simulation::last_frame() const { return impl()->made; }

const Scan& Simulation::scan(std::string_view sensor) const {
  const SimulationUse use = impl();
  const BuiltSensor& found = use->sensor(sensor);
  return require(found.sensor->scan(), found, "scan");
}

const Reading& Simulation::reading(std::string_view sensor) const {
  const SimulationUse use = impl();
  const BuiltSensor& found = use->sensor(sensor);
  return require(found.sensor->reading(), found, "reading");
}

Measurement Simulation::measurement(std::string_view sensor) const {
  const SimulationUse use = impl();
  Measurement measurement = use->measurement(sensor);
  measurement.on_request = use->sensor(sensor).sensor->on_request();
  return measurement;
}

Image Simulation::color(std::string_view sensor) const {
  const SimulationUse use = impl();
  return require_image(*use, sensor, "colour",
                       [](const MeasuredArray& each) { return each.content == ImageContent::color; });
}

Image Simulation::depth(std::string_view sensor) const {
  const SimulationUse use = impl();
  return require_image(*use, sensor, "depth",
                       [](const MeasuredArray& each) { return each.content == ImageContent::depth; });
}

Image Simulation::picture(std::string_view sensor, std::string_view name) const {
  const SimulationUse use = impl();
  return require_image(*use, sensor, "picture \"" + std::string(name) + "\"",
                       [&](const MeasuredArray& each) { return each.name == name; });
}

double Simulation::value(std::string_view sensor, std::string_view name) const {
  const std::optional<double> value = find_value(sensor, name);
  const SimulationUse use = impl();
  return require(value ? &*value : nullptr, use->sensor(sensor), "value \"" + std::string(name) + "\"");
}

std::optional<double> Simulation::find_value(std::string_view sensor, std::string_view name) const {
  const SimulationUse use = impl();
  const std::size_t index = use->idle().index(sensor);
  const Sensor& found = *use->scene.built.sensors[index].sensor;
  const std::optional<double> value = use->measurement(index).value(name);
  return value ? value : Measurement{.on_request = found.on_request()}.value(name);
}

Parameters& Simulation::parameters() { return impl()->scene.built.parameters; }
const Parameters& Simulation::parameters() const { return impl()->scene.built.parameters; }

bool Simulation::sensor_pose(std::string_view sensor, glm::dmat4& world_from_sensor) const {
  const SimulationUse use = impl();
  return use->idle().pose(use->sensor(sensor), world_from_sensor);
}

void Simulation::track_part(std::string_view part) { impl()->idle().track_part(part); }

bool Simulation::part_pose(std::string_view part, glm::dmat4& world_from_part) const {
  return impl()->idle().part_pose(part, world_from_part);
}

std::vector<SensorInfo> Simulation::sensors() const {
  std::vector<SensorInfo> infos;
  const SimulationUse use = impl();
  use->idle();
  for (std::size_t i = 0; i < use->scene.built.sensors.size(); ++i) {
    const BuiltSensor& sensor = use->scene.built.sensors[i];
    infos.push_back({sensor.name,
                     sensor.type,
                     sensor.sensor->method(),
                     use->states[i].frames,
                     use->states[i].enabled,
                     report_of(*sensor.sensor),
                     {},
                     use->states[i].effects,
                     find_sensor_type(sensor.type)->capabilities,
                     sensor.sensor->rate_hz});
  }
  return infos;
}

std::vector<SceneItem> Simulation::items() const { return impl()->idle().items(); }
std::span<const std::string> Simulation::measured() const { return impl()->measured; }

const std::vector<std::string>& Simulation::warnings() const { return impl()->scene.built.scene.warnings(); }
void Simulation::warn(const std::string& warning) { impl()->warn(warning); }
Diagnostics Simulation::diagnostics() const { return Diagnostics(*impl()); }

const BuiltScene& built_scene(const Simulation& simulation) { return simulation.impl()->idle().scene.built; }

void read_all_pictures(Simulation& simulation) { simulation.impl()->idle().reads_all_pictures = true; }

}  // namespace simvis
