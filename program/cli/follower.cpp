#include "program/cli/follower.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <optional>
#include <utility>

#include <simvis/element.h>
#include "program/cli/follow_link.h"
#include "program/cli/signals.h"
#include "sensors/measured_table.h"
#include "sensors/output_check.h"

namespace simvis {
namespace {

constexpr int kPoll_ms = 50;  // how often a signal is looked for

constexpr std::chrono::seconds kSilentSearch{3};  // before it is said that there is no host

}  // namespace

Follower::Follower(const std::string& follow, std::string own_scene, SimulationDesc desc)
    : name_(follow), own_scene_(std::move(own_scene)), desc_(std::move(desc)), host_(followed_host(follow)) {
  desc_.elements_move = false;
}

void Follower::connect(const Waiting& waiting) {
  has_host_ = false;
  const auto start = std::chrono::steady_clock::now();
  bool is_said = false;
  frame_ = {};
  while (frame_.frames == 0) {
    stop_if_asked_to();
    if (waiting) waiting(false);
    const bool is_there = host_->connect(kPoll_ms);
    if (is_there && host_->wait(0, kPoll_ms) == FollowedHost::Waited::frame) read_frame();
    if (is_there || is_said || std::chrono::steady_clock::now() - start < kSilentSearch) continue;
    std::cerr << "simvis-run: " << host_->missing() << "; waiting for it\n";
    is_said = true;
  }
  has_host_ = true;
}

Simulation Follower::open() {
  connect();
  Simulation simulation = build();
  own_is_required_ = false;
  return simulation;
}

void Follower::reconnect(Simulation& simulation, const Waiting& waiting) {
  std::cerr << "simvis-run: the host of \"" << name_ << "\" has ended; waiting for the next one\n";
  connect(waiting);
  first_frame_ = last_frame_ + 1;
  simulation = build();
}

// The values and the number of one frame.
void Follower::read_frame() { frame_ = host_->read(values_); }

// The commands of all entries that the frame is made with, and no others: requests that the host is executing now may
// be there in part.
Follower::Changes Follower::next_changes() {
  Changes changes;
  for (std::uint64_t position = log_position_; const auto change = host_->next_change(position);) {
    if (change->frame >= frame_.next_frame) break;
    log_position_ = position;
    changes.xml.append(change->xml).append("\n");
  }
  if (!changes.xml.empty()) changes.commands = parse_commands(changes.xml, "log of " + name_, "/");
  return changes;
}

Simulation Follower::build() {
  ++builds_;
  log_position_ = 0;
  own_parameter_.clear();
  copied_.clear();
  scanners_.clear();
  shown_.clear();
  stepped_ns_.reset();
  const Changes changes = next_changes();
  Simulation simulation = Simulation::from_string(changes.xml, desc_, "/", "log of " + name_);
  follow(simulation, changes.commands);
  add_own(simulation);
  copy_values(simulation);
  show_scans(simulation);
  return simulation;
}

void Follower::add_own(Simulation& simulation) {
  if (own_scene_.empty()) return;
  try {
    const std::vector<Command> commands = read_commands(own_scene_);
    std::ifstream file(own_scene_);
    const std::string xml{std::istreambuf_iterator<char>(file), {}};
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

// Any participant of a network may send values. One that the parameter cannot have does not end the follower.
void Follower::take_value(Parameters& parameters, std::size_t parameter, double value) {
  try {
    parameters.set(parameter, value);
  } catch (const InputError& error) {
    if (!std::exchange(has_refused_, true)) {
      std::cerr << "warning: a value of the host is left out: " << error.what() << '\n';
    }
  }
}

void Follower::copy_values(Simulation& simulation) {
  Parameters& parameters = simulation.parameters();
  const std::size_t known = std::min(own_parameter_.size(), values_.size());
  for (std::size_t i = 0; i < known; ++i) {
    if (i < copied_.size() && copied_[i] == values_[i]) continue;
    const std::size_t own = own_parameter_[i];
    if (!parameters.is_removed(own)) take_value(parameters, own, values_[i]);
  }
  copied_.assign(values_.begin(), values_.begin() + static_cast<std::ptrdiff_t>(known));
}

void Follower::show_scans(Simulation& simulation) {
  for (const std::string& scanner : scanners_) {
    const std::optional<FollowedHost::HostMeasurement> latest = host_->measurement(scanner, shown_[scanner]);
    if (!latest) continue;
    shown_[scanner] = latest->number;
    std::optional<Scan> scan = to_scan(latest->measurement);
    const std::vector<SensorInfo> sensors = simulation.sensors();
    if (scan && std::ranges::count(sensors, scanner, &SensorInfo::name) > 0) {
      simulation.show_scan(scanner, *std::move(scan));
    }
  }
}

void Follower::replay(Simulation& simulation) {
  const Changes changes = next_changes();
  if (changes.commands.empty()) return;
  try {
    simulation.execute(changes.xml, "/", "log of " + name_);
  } catch (const InputError&) {
    // The host's commands fail only because of the own ones: a name is taken, or something refers to what goes.
    simulation = build();
    return;
  }
  follow(simulation, changes.commands);
}

std::optional<FrameTime> Follower::advance(Simulation& simulation, const Waiting& waiting) {
  const bool first = !stepped_ns_;
  std::uint64_t seen = first ? frame_.frames - 1 : frame_.frames, before = frame_.next_frame;
  for (bool is_whole = false; !is_whole;) {
    if (received_signal() != nullptr) return {};
    const FollowedHost::Waited waited = host_->wait(seen, kPoll_ms);
    if (waited == FollowedHost::Waited::time_over) {
      if (waiting) waiting(true);
      continue;
    }
    if (waited == FollowedHost::Waited::host_ended) {
      reconnect(simulation, waiting);
      before = frame_.next_frame;
    }
    read_frame();
    seen = frame_.frames;
    is_whole = seen != 0;
  }
  if (frame_.next_frame != before) replay(simulation);
  copy_values(simulation);
  show_scans(simulation);
  last_frame_ = first_frame_ + frame_.next_frame - 1;
  return FrameTime{.index = last_frame_, .time_ns = frame_.time_ns};
}

bool Follower::set(const Simulation& simulation, std::size_t parameter, double value) {
  const auto found = std::ranges::find(own_parameter_, parameter);
  if (found == own_parameter_.end()) return false;
  require_host();
  host_->set(static_cast<std::size_t>(found - own_parameter_.begin()), simulation.parameters().name(parameter), value);
  return true;
}

void Follower::request(const std::string& xml) {
  require_host();
  host_->request(xml);
}

void Follower::require_host() const {
  if (!has_host_)
    throw InputError("the simulation " + in_quotes(name_) + " has ended, expected the next one of this name");
}

// What the type of the sensor says of an output is not sent with each measurement.
std::optional<Measurement> Follower::latest_measurement(const std::string& sensor,
                                                        std::span<const OutputSpec> outputs) {
  if (!has_host_) return {};
  std::optional<FollowedHost::HostMeasurement> latest = host_->measurement(sensor, 0);
  if (!latest) return {};
  // What a host sends counts if this sensor has such an output, and if the arrays fit together.
  Measurement& measured = latest->measurement;
  std::erase_if(measured.arrays, [&](MeasuredArray& each) {
    const OutputSpec* const spec = find_output(outputs, each.name);
    if (spec == nullptr) return true;
    const std::string unit = std::exchange(each.unit, {});
    describe(each, *spec);
    return unit != spec->unit || !output_difference(each, *spec).empty();
  });
  if (!fits_together(measured)) return {};
  return std::move(measured);
}

void Follower::step(Simulation& simulation) {
  const std::int64_t dt_ns = stepped_ns_ ? frame_.time_ns - *stepped_ns_ : 0;
  stepped_ns_ = frame_.time_ns;
  if (dt_ns > 0) return simulation.step(std::chrono::nanoseconds(dt_ns));
  simulation.step();
}

}  // namespace simvis
