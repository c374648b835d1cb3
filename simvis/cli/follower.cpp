#include "simvis/cli/follower.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <utility>

#include <simvis/element.h>
#include "simvis/cli/signals.h"

namespace simvis {
namespace {

constexpr int kPoll_ms = 50;  // how often a signal is looked for

template <typename Number>
std::vector<Number> numbers(const client::Measurement& measurement, const char* output) {
  const std::span<const Number> shared = measurement.output<Number>(output);
  return {shared.begin(), shared.end()};
}

/// Empty if the host has begun to write over it.
std::optional<Scan> copy_of(const client::Measurement& measurement) {
  const simvis_output* shape = nullptr;
  const simvis_view view = measurement.view();
  if (simvis_output_data(&view, "range_m", &shape) == nullptr) return {};
  Scan scan{.rings = shape->rows,
            .beams = shape->columns,
            .azimuth_rad = numbers<double>(measurement, "azimuth_rad"),
            .elevation_rad = numbers<double>(measurement, "elevation_rad"),
            .range_m = numbers<float>(measurement, "range_m"),
            .error_bound_m = numbers<float>(measurement, "error_bound_m"),
            .channels = {},
            .time_ns = measurement.slot().time_ns,
            .world_from_sensor = glm::dmat4(1)};
  for (int i = 0; i < 16; ++i) scan.world_from_sensor[i / 4][i % 4] = measurement.slot().world_from_sensor[i];
  const bool fits = scan.range_m.size() == std::size_t{scan.rings} * scan.beams &&
                    scan.azimuth_rad.size() == scan.beams && scan.elevation_rad.size() == scan.rings;
  if (!fits || !measurement.whole()) return {};
  return scan;
}

}  // namespace

Follower::Follower(std::string name, std::string own_scene, SimulationDesc desc)
    : name_(std::move(name)), own_scene_(std::move(own_scene)), desc_(std::move(desc)) {}

void Follower::connect() {
  const std::string own_name = "follower-" + std::to_string(::getpid());
  host_.reset();
  while (!host_) {
    stop_if_asked_to();
    try {
      host_.emplace(name_, own_name, kPoll_ms);
    } catch (const client::Error& error) {
      if (!simvis_is_missing()) throw MachineError(error.what());
    }
  }
  frame_ = {};
  while (frame_.frames == 0 && host_->alive()) {
    stop_if_asked_to();
    if (simvis_wait_frame(host_->get(), 0, kPoll_ms) == 1) read_frame();
  }
}

Simulation Follower::open() {
  do {
    connect();
  } while (frame_.frames == 0);
  Simulation simulation = build();
  own_is_required_ = false;
  return simulation;
}

void Follower::reconnect(Simulation& simulation) {
  std::cerr << "simvis-run: the host of \"" << name_ << "\" has ended; waiting for the next one\n";
  do {
    connect();
  } while (frame_.frames == 0);
  first_frame_ = last_frame_ + 1;
  simulation = build();
}

// The values and the number of one frame.
void Follower::read_frame() {
  values_.resize(simvis_parameter_count(host_->get()));
  if (simvis_applied_frame(host_->get(), 0, values_.data(), values_.size(), &frame_) != 0) frame_ = {};
}

// The commands of all entries that the frame is made with, and no others: requests that the host is executing now may
// be there in part.
std::vector<Command> Follower::next_commands() {
  std::vector<Command> commands;
  for (std::uint64_t position = log_position_; const auto entry = host_->next_log(position);) {
    if (entry->frame >= frame_.next_frame) break;
    log_position_ = position;
    if (entry->kind != SIMVIS_CHANGE) continue;
    const std::vector<Command> parsed = parse_commands(entry->text, "log of " + name_, "/");
    commands.insert(commands.end(), parsed.begin(), parsed.end());
  }
  return commands;
}

Simulation Follower::build() {
  ++builds_;
  log_position_ = 0;
  own_parameter_.clear();
  copied_.clear();
  scanners_.clear();
  shown_.clear();
  stepped_ns_.reset();
  const std::vector<Command> commands = next_commands();
  std::string xml;
  for (const Command& command : commands) xml += to_string(command) + "\n";
  Simulation simulation = Simulation::from_string(xml, desc_, "/", "log of " + name_);
  follow(simulation, commands);
  add_own(simulation);
  copy_values(simulation);
  show_scans(simulation);
  return simulation;
}

void Follower::add_own(Simulation& simulation) {
  if (own_scene_.empty()) return;
  const std::vector<Command> commands = read_commands(own_scene_);
  std::ifstream file(own_scene_);
  const std::string xml{std::istreambuf_iterator<char>(file), {}};
  try {
    simulation.execute(xml, std::filesystem::path(own_scene_).parent_path(), own_scene_);
    note_scanners(commands);
  } catch (const InputError& error) {
    if (own_is_required_) throw;
    std::cerr << "warning: " << own_scene_ << " is left out of the changed scene: " << error.what() << '\n';
  }
}

// The commands have just been executed: their elements are the last ones of the scene.
void Follower::follow(Simulation& simulation, std::span<const Command> commands) {
  const std::vector<ElementDescriptor>& elements = simulation.parameters().elements();
  const auto made = static_cast<std::size_t>(std::ranges::count(commands, CommandKind::element, &Command::kind));
  for (std::size_t i = elements.size() - made; i < elements.size(); ++i) {
    for (std::size_t p = 0; p < elements[i].parameters.size(); ++p) {
      own_parameter_.push_back(elements[i].first_value + p);
    }
  }
  std::set<std::string> sensors;
  for (const Command& command : commands) {
    if (command.kind == CommandKind::sensor) sensors.insert(command.require("name").value);
  }
  for (const SensorInfo& sensor : simulation.sensors()) {
    if (sensors.contains(sensor.name)) simulation.enable(sensor.name, false);
  }
  note_scanners(commands);
}

void Follower::note_scanners(std::span<const Command> commands) {
  for (const Command& command : commands) {
    if (command.kind != CommandKind::element) continue;
    for (const AttributeSpec& spec : find_element_type(command.require("type").value)->attributes) {
      const CommandAttribute* const attribute = command.find(spec.name);
      if (spec.kind == AttributeKind::sensor && attribute != nullptr) scanners_.insert(attribute->value);
    }
  }
}

void Follower::copy_values(Simulation& simulation) {
  Parameters& parameters = simulation.parameters();
  const std::size_t known = std::min(own_parameter_.size(), values_.size());
  for (std::size_t i = 0; i < known; ++i) {
    if (i < copied_.size() && copied_[i] == values_[i]) continue;
    const std::size_t own = own_parameter_[i];
    if (!parameters.is_removed(own)) parameters.set(own, values_[i]);
  }
  copied_.assign(values_.begin(), values_.begin() + static_cast<std::ptrdiff_t>(known));
}

void Follower::show_scans(Simulation& simulation) {
  for (const std::string& scanner : scanners_) {
    const std::int64_t id = simvis_find_sensor(host_->get(), scanner.c_str());
    const std::optional<client::Measurement> latest = id < 0 ? std::nullopt : host_->latest(id);
    if (!latest || latest->view().sequence == shown_[scanner]) continue;
    std::optional<Scan> scan = copy_of(*latest);
    if (!scan) continue;
    shown_[scanner] = latest->view().sequence;
    const std::vector<SensorInfo> sensors = simulation.sensors();
    if (std::ranges::count(sensors, scanner, &SensorInfo::name) > 0) simulation.show_scan(scanner, std::move(*scan));
  }
}

void Follower::replay(Simulation& simulation) {
  const std::vector<Command> commands = next_commands();
  if (commands.empty()) return;
  std::string xml;
  for (const Command& command : commands) xml += to_string(command) + "\n";
  try {
    simulation.execute(xml, "/", "log of " + name_);
  } catch (const InputError&) {
    // The host's commands fail only because of the own ones: a name is taken, or something refers to what goes.
    simulation = build();
    return;
  }
  follow(simulation, commands);
}

std::optional<FrameTime> Follower::advance(Simulation& simulation) {
  const bool first = !stepped_ns_;
  const std::uint64_t seen = first ? frame_.frames - 1 : frame_.frames;
  for (int waited = 0; waited != 1;) {
    if (received_signal() != nullptr) return {};
    waited = simvis_wait_frame(host_->get(), seen, kPoll_ms);
    if (waited >= 0) continue;
    reconnect(simulation);
    break;
  }
  const std::uint64_t before = frame_.next_frame;
  read_frame();
  if (frame_.frames == 0) return advance(simulation);  // killed while it wrote
  if (frame_.next_frame != before) replay(simulation);
  copy_values(simulation);
  show_scans(simulation);
  last_frame_ = first_frame_ + frame_.next_frame - 1;
  return FrameTime{.index = last_frame_, .time_ns = frame_.time_ns};
}

bool Follower::set(std::size_t parameter, double value) {
  const auto found = std::ranges::find(own_parameter_, parameter);
  if (found == own_parameter_.end()) return false;
  simvis_set(host_->get(), found - own_parameter_.begin(), value);
  return true;
}

void Follower::request(const std::string& xml) {
  if (simvis_send(host_->get(), xml.c_str()) == 0)
    throw InputError(name_ + ": takes no request now: " + simvis_client_error());
}

std::optional<Scan> Follower::latest_scan(const std::string& sensor) {
  const std::int64_t id = simvis_find_sensor(host_->get(), sensor.c_str());
  const std::optional<client::Measurement> latest = id < 0 ? std::nullopt : host_->latest(id);
  return latest ? copy_of(*latest) : std::nullopt;
}

void Follower::step(Simulation& simulation) {
  const std::int64_t dt_ns = stepped_ns_ ? frame_.time_ns - *stepped_ns_ : 0;
  stepped_ns_ = frame_.time_ns;
  if (dt_ns > 0) return simulation.step(std::chrono::nanoseconds(dt_ns));
  simulation.step();
}

}  // namespace simvis
