#include "program/cli/run.h"

#include <algorithm>
#include <chrono>
#include <iostream>
#include <iterator>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/now_ns.h"
#include "program/cli/begin_report.h"
#include "program/cli/load_scene.h"
#include "program/cli/memory_reserve.h"
#include "program/cli/progress_bar.h"
#include "program/cli/run_messages.h"
#include "program/cli/signals.h"
#include "program/output/atomic_file.h"
#include "program/report/shard.h"
#include "simvis/built_scene.h"

namespace simvis {
namespace {

void add_frame(Profile& profile, std::uint64_t frame, const Simulation& simulation) {
  profile.add({.index = frame,
               .stages = simulation.diagnostics().stages(),
               .written_ns = now_ns(),
               .sensors = simulation.diagnostics().sensor_costs(),
               .counters = simulation.diagnostics().counters(),
               .device_memory_bytes = simulation.diagnostics().device_memory_bytes()});
  profile.add(simulation.diagnostics().frame_plan(), *simulation.diagnostics().frame_costs());
  if (const FramePlan* const plan = simulation.diagnostics().visualization_plan())
    profile.add(*plan, *simulation.diagnostics().visualization_costs());
}

/// Whether frames before the first one of this process can be skipped. Otherwise they are made again.
bool can_skip(const Simulation& simulation) {
  try {
    simulation.require_skippable();
    return true;
  } catch (const InputError&) {
    return false;
  }
}

// "SENSOR=REST" or "REST". A path with '=' is written with its folder: ./a=b.pcap.
std::pair<std::string, std::string> sensor_and_rest(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || text.find('/') < equals) return {"", text};
  return {text.substr(0, equals), text.substr(equals + 1)};
}

}  // namespace

Run::Run(const Options& options, Simulation& simulation, const std::optional<Trajectory>& trajectory,
         Follower* follower, LiveRun* live, std::int64_t start_ns)
    : options_(options),
      simulation_(simulation),
      trajectory_(trajectory),
      follower_(follower),
      live_(live),
      start_ns_(start_ns),
      report_(begin_report(options, simulation)) {
  begin_clock();
}

void Run::begin_clock() {
  if (live_ != nullptr) {
    real_time_.emplace(options_.real_time, [this](std::int64_t due_ns) { live_->wait(simulation_, due_ns); });
    live_->control(*real_time_);
  } else if (options_.real_time > 0) {
    real_time_.emplace(options_.real_time);
  }
}

bool Run::prepare() {
  if (options_.writes) {
    folder_.emplace(options_, report_);
    if (folder_->is_complete()) return false;
  }
  if (!options_.dataset.empty() && !begin_dataset()) return false;
  views_.emplace(options_.export_file, options_.page);
  if (!options_.profile.empty()) {
    in_option("--profile", [&] { profile_.emplace(options_.profile, report_.device.name); });
  }
  return true;
}

/// Returns false if the dataset has all frames. A run that was killed may lack the files of the whole.
bool Run::begin_dataset() {
  dataset_.emplace(options_, report_, simulation_);
  if (!dataset_->has_all()) return true;
  dataset_->finish();
  return false;
}

// Follows the first frame: a run that cannot make it leaves the results of the earlier run alone.
void Run::begin_output() {
  folder_->replace();
  write_report();
  open_writer();
}

void Run::open_writer() {
  OutputDesc desc{.folder = options_.out,
                  .parts = options_.poses,
                  .suffix = suffix(),
                  .threads = options_.simulation.threads,
                  .formats = report_.record.formats};
  for (const SensorInfo& sensor : report_.sensors) {
    if (sensor.enabled) desc.sensors.push_back(sensor.name);
  }
  if (folder_->resumes()) desc.resume_at = folder_->first_frame();
  desc.on_new_file = [this](const RunFiles& files) {
    if (!folder_->resumes()) report_.files.clear();
    for (const auto& [name, own] : files) {
      std::vector<std::string>& all = report_.files[name];
      std::ranges::copy_if(own, std::back_inserter(all),
                           [&](const std::string& file) { return std::ranges::find(all, file) == all.end(); });
    }
    write_report();
  };
  writer_.emplace(std::move(desc));
}

void Run::write_report() {
  report_.warnings = simulation_.warnings();
  report_.simulated_s = static_cast<double>(simulation_.next_frame().time_ns) / 1e9;
  if (!options_.endless) {
    const auto next = static_cast<double>(std::max<std::uint64_t>(simulation_.next_frame().index, 1));
    report_.simulated_s *= static_cast<double>(report_.frame_ms.added()) / next;
  }
  if (real_time_ && real_time_->factor() > 0) report_.real_time = {real_time_->factor(), real_time_->punctuality()};
  report_.wall_s = static_cast<double>(now_ns() - start_ns_) / 1e9;
  write_file(folder_->report_file(), to_json(report_));
}

std::set<std::string> Run::enabled_sensors() const {
  std::set<std::string> names;
  for (const SensorInfo& sensor : report_.sensors) {
    if (sensor.enabled) names.insert(sensor.name);
  }
  return names;
}

void Run::make_frames(std::optional<LoadingBar>& loading, WarningPrinter& warnings) {
  const std::uint64_t first_frame = folder_ ? folder_->first_frame() : 0;
  const Shard shard = report_.shard.value_or(Shard{});
  ProgressBar progress(std::cerr, shows_progress(options_) && !options_.endless,
                       shard.share_of(options_.frames) - shard.share_of(first_frame), std::chrono::steady_clock::now());
  written_.start(enabled_sensors(), simulation_);
  const bool skips = (first_frame == 0 && !dataset_) || can_skip(simulation_);
  const auto is_made = [&](std::uint64_t frame) { return frame < first_frame || (dataset_ && dataset_->has(frame)); };
  for (std::uint64_t frame = 0; frame < options_.frames && received_signal() == nullptr;) {
    const double now_s = static_cast<double>(simulation_.next_frame().time_ns) / 1e9;
    if (trajectory_) trajectory_->apply(now_s, simulation_.parameters());
    if (!shard.has(frame) || (is_made(frame) && skips)) {
      simulation_.skip_frame();
      ++frame;
      continue;
    }
    const std::optional<FrameTime> time = next_time();
    if (!time) break;
    if (frame >= first_frame) begin_recording();
    if (frame + 1 == options_.frames && !options_.failure.empty()) simulation_.warn(options_.failure);
    const std::int64_t start_ns = now_ns();
    if (!step()) continue;  // it is tried again
    const double step_ms = static_cast<double>(now_ns() - start_ns) / 1e6;
    loading.reset();
    warnings.print_new(simulation_);
    if (++frame > first_frame) {  // otherwise it was made again for the frames that follow
      keep(*time, step_ms);
      report_.next_frame = frame;
      if (profile_) add_frame(*profile_, frame - 1, simulation_);
      progress.update(report_.frame_ms.added(), std::chrono::steady_clock::now());
    }
    if (outlet_failure_) std::rethrow_exception(outlet_failure_);
    require_memory();
  }
}

/// Waits until the next frame is due, and has its scene. Empty: a signal came.
std::optional<FrameTime> Run::next_time() {
  FrameTime time = simulation_.next_frame();
  if (live_ != nullptr) live_->before_frame(simulation_);
  if (real_time_) real_time_->wait(time);
  if (follower_ != nullptr) time = follow().value_or(time);
  if (received_signal() != nullptr) return std::nullopt;
  if (views_->any() || live_ != nullptr) read_all_pictures(simulation_);  // a follower may have built another one
  return time;
}

/// As Follower::advance(); clients of the live view are served meanwhile.
std::optional<FrameTime> Run::follow() {
  Follower::Waiting serve;
  if (live_ != nullptr) serve = [this](bool has_host) { live_->while_waiting(simulation_, has_host); };
  return follower_->advance(simulation_, serve);
}

/// Returns false if the frame could not be made because of what a client of the live view has changed.
bool Run::step() {
  try {
    follower_ != nullptr ? follower_->step(simulation_) : simulation_.step();
  } catch (const OutletError&) {
    outlet_failure_ = std::current_exception();
  } catch (const InputError& error) {
    if (live_ == nullptr || !live_->takes_blame(error, simulation_)) throw;
    return false;
  }
  return true;
}

/// Everything that is kept of the frame just made.
void Run::keep(const FrameTime& time, double step_ms) {
  report_.frame_ms.add(step_ms);
  views_->add(simulation_, time);
  if (live_ != nullptr) live_->after_frame(simulation_, time, step_ms);
  if (options_.writes) write_frame(time);
  if (dataset_) dataset_->add(time);
  if (report_.frame_ms.added() == 1) first_done_ns_ = now_ns();
}

void Run::write_frame(const FrameTime& time) {
  if (!writer_) begin_output();
  if (follower_ == nullptr) written_.follow(simulation_);
  write_results(options_.poses, simulation_, written_, time, *writer_);
}

// Frames that a resumed run makes again are not recorded.
void Run::begin_recording() {
  if (!std::exchange(packets_begun_, true)) begin_packets();
  if (options_.record.empty() || recording_) return;
  recording_ = true;
  in_option("--record", [&] {
    const std::filesystem::path file = options_.record;
    if (options_.no_replace && std::filesystem::exists(file)) {
      throw InputError(file.string() + " exists, and --no-replace is given, expected another file");
    }
    if (file.has_parent_path()) make_folder(file.parent_path());
    simulation_.record({.file = file, .topics = options_.record_topics, .drop = options_.record_policy == "drop"});
  });
}

void Run::begin_packets() {
  if (!options_.record_pcap.empty()) {
    in_option("--record-pcap", [&] {
      const auto [sensor, name] = sensor_and_rest(options_.record_pcap);
      const std::filesystem::path file = name;
      if (options_.no_replace && std::filesystem::exists(file)) {
        throw InputError(file.string() + " exists, and --no-replace is given, expected another file");
      }
      if (file.has_parent_path()) make_folder(file.parent_path());
      simulation_.record_packets({.file = file, .sensor = sensor});
    });
  }
  if (options_.udp.empty()) return;
  in_option("--udp", [&] {
    const auto [sensor, address] = sensor_and_rest(options_.udp);
    simulation_.send_packets({.address = address, .sensor = sensor});
  });
}

void Run::finish() {
  require_memory();
  if (options_.writes) {
    if (!writer_ && received_signal() != nullptr) return;
    if (!writer_) begin_output();
  }
  if (options_.explain && received_signal() == nullptr) print_explanation(simulation_);
  if (options_.writes) close_sensors();
  if (writer_) writer_->finish();
  if (dataset_) dataset_->finish();
  if (report_.frame_ms.added() > 1) report_.later_frames_s = static_cast<double>(now_ns() - first_done_ns_) / 1e9;
  if (recording_) report_.recording = simulation_.finish_recording();
  if (packets_begun_ && !options_.record_pcap.empty()) report_.packets = simulation_.finish_packet_recording();
  if (packets_begun_ && !options_.udp.empty()) report_.sent_packets = simulation_.stop_packets();
  if (options_.dds) report_.dds = simulation_.leave_dds();
  require_memory();
  if (profile_) profile_->commit();
  views_->finish(simulation_);
  if (received_signal() == nullptr) report_.next_frame = options_.frames;
  report_.status = report_.next_frame == options_.frames ? "complete" : "stopped";
  if (!options_.writes) return;
  write_report();
  if (!options_.quiet) print_closing(options_, folder_->report_file(), *writer_, report_);
}

/// The report names the sensors of the scene file, also those that were removed during the run. Their error bounds are
/// computed while the last pictures are encoded.
void Run::close_sensors() {
  const std::vector<SensorInfo> now = with_bounds(simulation_);
  for (SensorInfo& sensor : report_.sensors) {
    const auto found = std::ranges::find(now, sensor.name, &SensorInfo::name);
    if (written_.contains(sensor.name) && found != now.end()) sensor = *found;
    if (sensor.enabled) sensor.frames = writer_->frames(sensor.name);
  }
}

/// Of a run that fails. Their locks may lie in the folder of results, which goes if it is empty.
void Run::end_recordings() {
  try {
    if (recording_) simulation_.finish_recording();
    if (packets_begun_ && !options_.record_pcap.empty()) simulation_.finish_packet_recording();
  } catch (const std::exception&) {  // the exception that ended the run is the one to report
  }
}

void Run::fail() {
  end_recordings();
  if (!writer_) return;
  try {
    writer_->finish();
  } catch (const std::exception&) {  // the exception that ended the run is the one to report
  }
  try {
    report_.status = "failed";
    write_report();
  } catch (const std::exception&) {  // as on a full disk: the report then says "running", as after a kill
  }
}

}  // namespace simvis
