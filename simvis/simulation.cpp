#include <simvis/simulation.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include <simvis/effect.h>
#include <simvis/pose.h>
#include "engine/base/stack_limit.h"
#include "engine/vulkan/device_impl.h"
#include "engine/vulkan/sharing/open_devices.h"
#include "simvis/built_scene.h"
#include "simvis/command_names.h"
#include "simvis/element_motion.h"
#include "simvis/sharing/network.h"
#include "simvis/sharing/packet_recording.h"
#include "simvis/sharing/packet_stream.h"
#include "simvis/sharing/recording.h"
#include "simvis/sharing/serving.h"
#include "simvis/simulation_use.h"
#include "simvis/unbuilt_scene.h"

namespace simvis {

namespace {

constexpr double kRigidTolerance = 1e-6;  // of unit vectors: far above float32's rounding, far below any scale meant

template <typename Output>
const Output& require(const Output* output, const BuiltSensor& sensor, std::string_view what) {
  if (output != nullptr) return *output;
  throw InputError("sensor \"" + sensor.name + "\", a " + sensor.type + ", has no " + std::string(what));
}

// The first image of a sensor that is wanted.
template <typename Wanted>
Image require_image(SimulationImpl& simulation, std::string_view sensor, std::string_view what, const Wanted& wanted) {
  for (const MeasuredArray& each : simulation.sensors.measurement(sensor).arrays) {
    if (!wanted(each)) continue;
    if (std::optional<Image> image = to_image(each)) return *std::move(image);
  }
  return require<Image>(nullptr, simulation.sensor(sensor), what);
}

// Opens an outlet, of which a simulation has one at most: with another one there, throws InputError with `refusal`.
template <typename Outlet, typename Desc>
Outlet& open_outlet(SimulationImpl& simulation, const Desc& desc, const char* refusal) {
  FrameOutlets& outlets = simulation.idle().outlets;
  if (outlets.find<Outlet>() != nullptr) throw InputError(refusal);
  auto outlet = std::make_unique<Outlet>(desc, simulation.scene.built);
  Outlet& opened = *outlet;
  outlets.add(std::move(outlet));
  return opened;
}

// Ends an outlet, adds its last warnings and returns its report. If it is not there, throws InputError with `refusal`.
template <typename Outlet>
auto close_outlet(SimulationImpl& simulation, const char* refusal) {
  const std::unique_ptr<Outlet> outlet = simulation.idle().outlets.remove<Outlet>();
  if (outlet == nullptr) throw InputError(refusal);
  auto report = outlet->finish();
  for (const std::string& warning : outlet->take_warnings()) simulation.warn(warning);
  return report;
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

/// Whether a command adds a sensor of a type that always draws.
bool makes_pictures(const Command& command) {
  const CommandAttribute* const type = command.kind == CommandKind::sensor ? command.find("type") : nullptr;
  const SensorType* const found = type == nullptr ? nullptr : find_sensor_type(type->value);
  return found != nullptr && (found->capabilities & kHasImageSensor) != 0;
}

bool is_selected(const Command& command, const SimulationDesc& desc) {
  const CommandAttribute* const name = command.find("name");
  if (desc.sensors.empty() || name == nullptr) return true;
  return std::ranges::count(desc.sensors, prefix_of(command) + name->value) > 0;
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
  const UnbuiltScene source = UnbuiltScene::of_file(scene);
  std::optional<DeviceOpening> opening;  // while parts are read, which takes about as long
  const auto opens = [&](const Command& command) { return is_selected(command, desc) && makes_pictures(command); };
  if (std::ranges::any_of(source.commands, opens)) opening.emplace(choice_of(desc.device));
  return Simulation(source.build(desc));
}

Simulation Simulation::from_string(std::string_view xml, const SimulationDesc& desc,
                                   const std::filesystem::path& folder, const std::string& name) {
  const ProcessUse process;
  require_stack();
  return Simulation(UnbuiltScene::of_text(xml, folder, name).build(desc));
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
  use->inputs.add(inputs);
  use->follow_scene();
}

void Simulation::serve(const ServeDesc& desc) {
  const SimulationUse use = impl();
  open_outlet<Serving>(*use, desc, "the simulation is served already, expected one call of serve()");
  if (Network* const network = use->outlets.find<Network>()) network->serve_as(desc.name);
}

void Simulation::record(const RecordDesc& desc) {
  open_outlet<Recording>(*impl(), desc, "the simulation is recorded already, expected finish_recording() before");
}

RecordReport Simulation::finish_recording() {
  return close_outlet<Recording>(*impl(), "the simulation is not recorded, expected record() before");
}

void Simulation::record_packets(const PacketRecordDesc& desc) {
  const SimulationUse use = impl();
  use->idle().outlets.add(std::make_unique<PacketRecording>(desc, use->scene.built));
}

PacketReport Simulation::finish_packet_recording() {
  return close_outlet<PacketRecording>(*impl(), "no packets are recorded, expected record_packets() before");
}

void Simulation::send_packets(const PacketStreamDesc& desc) {
  open_outlet<PacketStream>(*impl(), desc, "packets are sent already, expected stop_packets() before");
}

PacketReport Simulation::stop_packets() {
  return close_outlet<PacketStream>(*impl(), "no packets are sent, expected send_packets() before");
}

DdsReach Simulation::join_dds(const DdsDesc& desc) {
  const SimulationUse use = impl();
  Network& network =
      open_outlet<Network>(*use, desc, "the simulation takes part in DDS already, expected leave_dds() before");
  if (const Serving* const serving = use->outlets.find<Serving>()) network.serve_as(serving->served_name());
  return network.reach();
}

DdsReport Simulation::leave_dds() {
  return close_outlet<Network>(*impl(), "the simulation does not take part in DDS, expected join_dds() before");
}

void Simulation::show_scan(std::string_view sensor, Scan scan) {
  const SimulationUse use = impl();
  const BuiltSensor& found = use->idle().sensor(sensor);
  ShownScan& shown = use->sensors.shown[found.id];
  shown.scan = std::move(scan);
  ++shown.count;
}

void Simulation::add_variant(std::string_view sensor, const Command& command) {
  const SimulationUse use = impl();
  use->idle().measure_skipped();
  use->scene.add_variant(use->sensors.index(sensor), command);
  use->follow_scene();
}

void Simulation::enable(std::string_view sensor, bool on) {
  const SimulationUse use = impl();
  use->idle().enable(sensor, on);
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

std::string Simulation::save_state() { return impl()->save_state(); }
void Simulation::restore_state(std::string_view state) { impl()->restore_state(state); }

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
  Measurement measurement = use->sensors.measurement(sensor);
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
  const std::size_t index = use->idle().sensors.index(sensor);
  const Sensor& found = *use->scene.built.sensors[index].sensor;
  const std::optional<double> value = use->sensors.measurement(index).value(name);
  return value ? value : Measurement{.on_request = found.on_request()}.value(name);
}

Parameters& Simulation::parameters() { return impl()->scene.built.parameters; }
const Parameters& Simulation::parameters() const { return impl()->scene.built.parameters; }

bool Simulation::sensor_pose(std::string_view sensor, glm::dmat4& world_from_sensor) const {
  const SimulationUse use = impl();
  return use->idle().pose(use->sensor(sensor), world_from_sensor);
}

void Simulation::track_part(std::string_view part) {
  const SimulationUse use = impl();
  use->idle().tracked_parts.track(part, use->scene.built.scene);
}

bool Simulation::part_pose(std::string_view part, glm::dmat4& world_from_part) const {
  const SimulationUse use = impl();
  return use->idle().tracked_parts.pose(part, use->sensing.flattener, world_from_part);
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
                     use->sensors.all[i].frames,
                     use->sensors.all[i].enabled,
                     report_of(*sensor.sensor),
                     {},
                     use->sensors.all[i].effects,
                     find_sensor_type(sensor.type)->capabilities,
                     sensor.sensor->rate_hz});
  }
  return infos;
}

std::vector<SceneItem> Simulation::items() const { return impl()->idle().items(); }

std::vector<SceneObject> Simulation::objects() const { return impl()->idle().objects(); }
std::span<const std::string> Simulation::measured() const { return impl()->sensors.measured; }

const std::vector<std::string>& Simulation::warnings() const { return impl()->scene.built.scene.warnings(); }
void Simulation::warn(const std::string& warning) { impl()->warn(warning); }
Diagnostics Simulation::diagnostics() const { return Diagnostics(*impl()); }

const BuiltScene& built_scene(const Simulation& simulation) { return simulation.impl()->idle().scene.built; }

const BuiltScene& updated_scene(Simulation& simulation) {
  BuiltScene& built = simulation.impl()->idle().scene.built;
  update_elements(built);
  return built;
}

void read_all_content(Simulation& simulation) { simulation.impl()->idle().reads_all = true; }

std::uint64_t frames_until(const Simulation& simulation, std::int64_t end_ns) {
  const SimulationUse use = simulation.impl();
  return use->timeline.frames_until(end_ns, use->sensors.rates());
}

}  // namespace simvis
