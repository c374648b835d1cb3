#include "simvis/cli/run_scene.h"

#include <algorithm>
#include <chrono>
#include <iostream>
#include <iterator>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include <simvis/trajectory.h>
#include "engine/base/now_ns.h"
#include "sensors/laser_scanner/laser_scanner.h"
#include "simvis/built_scene.h"
#include "simvis/cli/follower.h"
#include "simvis/cli/live_run.h"
#include "simvis/cli/load_scene.h"
#include "simvis/cli/loading_bar.h"
#include "simvis/cli/progress_bar.h"
#include "simvis/cli/real_time.h"
#include "simvis/cli/signals.h"
#include "simvis/cli/view_files.h"
#include "simvis/cli/warning_printer.h"
#include "simvis/output/atomic_file.h"
#include "simvis/output/folder_lock.h"
#include "simvis/output/output_writer.h"
#include "simvis/report/earlier_run.h"
#include "simvis/report/explain.h"
#include "simvis/report/profile.h"
#include "simvis/report/run_report.h"
#include "simvis/report/shard.h"
#include "simvis/report/summary.h"

namespace simvis {
namespace {

/// Sensors of the scene file write files. Those that clients add while it runs have the shared memory.
class WrittenSensors {
 public:
  void start(std::set<std::string> names, const Simulation& simulation) {
    names_ = std::move(names);
    changes_ = simulation.parameters().changes().size();
  }
  /// A sensor that was removed writes nothing more, whoever gets its name.
  void follow(const Simulation& simulation) {
    const std::vector<std::string>& log = simulation.parameters().changes();
    for (; changes_ < log.size(); ++changes_) {
      const Command command = parse_commands(log[changes_], "log", ".").front();
      if (command.kind != CommandKind::remove || command.require("kind").value != "sensor") continue;
      names_.erase(command.require("name").value);
    }
  }
  bool contains(const std::string& name) const { return names_.contains(name); }

 private:
  std::set<std::string> names_;
  std::size_t changes_ = 0;
};

/// Whether a scan of this frame says which items its beams hit.
bool names_items(const Simulation& simulation, const WrittenSensors& written) {
  const std::vector<SensorInfo> sensors = simulation.sensors();
  return std::ranges::any_of(simulation.measured(), [&](const std::string& name) {
    const auto sensor = std::ranges::find(sensors, name, &SensorInfo::name);
    const bool casts = sensor != sensors.end() && (sensor->capabilities & kCastsBeams) != 0;
    return casts && written.contains(name) && simulation.scan(name).channel(kTrueItem) != nullptr;
  });
}

void write_results(const Options& options, const Simulation& simulation, const WrittenSensors& written,
                   const FrameTime& time, OutputWriter& writer) {
  glm::dmat4 pose;
  for (const std::string& part : options.poses) {
    if (simulation.part_pose(part, pose)) writer.part_pose(part, time, pose);
  }
  for (const std::string& sensor : simulation.measured()) {
    if (!written.contains(sensor)) continue;
    simulation.sensor_pose(sensor, pose);
    simulation.write(sensor, writer.sink(sensor, time, pose));
  }
  if (names_items(simulation, written)) writer.items(time, simulation.items());
}

void print_explanation(const Simulation& simulation) {
  const Diagnostics diagnostics = simulation.diagnostics();
  std::cout << explain(diagnostics.frame_plan(), {diagnostics.counters(), diagnostics.planned_sensors(),
                                                  diagnostics.frame_costs(), diagnostics.sensor_costs()});
  for (const SensorInfo& sensor : simulation.sensors()) std::cout << sensor.report.explanation;
  const FramePlan* const visualization = diagnostics.visualization_plan();
  if (visualization == nullptr) return;
  std::cout << "visualization, drawn apart:\n"
            << explain(*visualization, {*diagnostics.visualization_counters(), diagnostics.visualization_sensors(),
                                        diagnostics.visualization_costs(), diagnostics.sensor_costs()});
}

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

/// Empty without --shard.
std::optional<Shard> wanted_shard(const Options& options, const Simulation& simulation) {
  std::optional<Shard> shard;
  if (options.shard.empty()) return shard;
  in_option("--shard", [&] {
    shard = parse_shard(options.shard);
    if (shard->share_of(options.frames) == 0) {
      throw InputError(options.shard + " has no frame of " + std::to_string(options.frames) +
                       ", expected K below --frames");
    }
    if (shard->count > 1) simulation.require_skippable();
  });
  return shard;
}

std::filesystem::path report_file(const Options& options, const RunReport& report) {
  return std::filesystem::path(options.out) / ("run" + (report.shard ? report.shard->suffix() : "") + ".json");
}

void print_closing(const Options& options, const OutputWriter& writer, const RunReport& report) {
  std::cout << "wrote ";
  for (const std::string& result : writer.results()) std::cout << result << ", ";
  for (const std::string* const view : {&options.export_file, &options.page}) {
    if (!view->empty()) std::cout << *view << ", ";
  }
  if (report.recording) {
    std::cout << report.recording->file.string() << " (" << report.recording->messages << " messages";
    if (report.recording->dropped > 0) std::cout << ", " << report.recording->dropped << " dropped";
    std::cout << "), ";
  }
  if (report.dds) std::cout << report.dds->messages << " messages by DDS, ";
  std::cout << report_file(options, report).string() << '\n' << speed_line(report) << '\n';
}

void print_summary(const Options& options, Simulation simulation, const std::optional<Trajectory>& trajectory,
                   const RunReport& report) {
  std::cout << to_text(
      summarize(std::move(simulation), {.rate_hz = options.rate_hz,
                                        .frame_ms = percentile(report.frame_ms, 50),
                                        .later_frames = std::max<std::size_t>(report.frame_ms.size(), 1) - 1,
                                        .later_frames_s = report.later_frames_s,
                                        .out = options.out,
                                        .trajectory = trajectory ? &*trajectory : nullptr,
                                        .on_frame = stop_if_asked_to}));
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

/// The run of one command line, from the loaded scene to its report.
class Run {
 public:
  /// `follower` is null unless the frames are those of another process.
  /// `live` is null without --live.
  Run(const Options& options, Simulation& simulation, const std::optional<Trajectory>& trajectory, Follower* follower,
      LiveRun* live, std::int64_t start_ns)
      : options_(options),
        simulation_(simulation),
        trajectory_(trajectory),
        follower_(follower),
        live_(live),
        start_ns_(start_ns) {
    describe();
  }

  /// Takes the folder and what an earlier run left in it. Returns false if there is nothing left to do.
  bool prepare();
  void make_frames(std::optional<LoadingBar>& loading, WarningPrinter& warnings);
  void finish();
  /// After an exception: keeps what is whole and says in the report that the run failed, if that is still possible.
  void fail();
  const RunReport& report() const { return report_; }

 private:
  void describe();
  bool prepare_folder();
  void go_on(const EarlierRun& earlier);
  void begin_output();
  void replace(const EarlierRun& earlier);
  void open_writer();
  void begin_recording();
  void write_report();
  void close_sensors();
  bool step();
  void write_frame(const FrameTime& time);
  std::string suffix() const { return report_.shard ? report_.shard->suffix() : ""; }

  const Options& options_;
  Simulation& simulation_;
  const std::optional<Trajectory>& trajectory_;
  Follower* follower_;
  LiveRun* live_;
  std::int64_t start_ns_;
  RunReport report_;
  std::optional<EarlierRun> earlier_;
  std::uint64_t first_frame_ = 0;
  std::int64_t first_done_ns_ = 0;  // end of the first frame of this process
  bool resumes_ = false;
  bool recording_ = false;
  std::optional<FolderLock> lock_;
  std::optional<Profile> profile_;
  std::optional<OutputWriter> writer_;
  WrittenSensors written_;
  std::optional<RealTime> real_time_;
  std::optional<ViewFiles> views_;
};

void Run::describe() {
  report_.scene = options_.scene;
  report_.shard = wanted_shard(options_, simulation_);
  report_.device = simulation_.diagnostics().device();
  report_.seed = options_.seed;
  report_.rate_hz = options_.rate_hz;
  report_.frames_when_due = options_.frames_when_due;
  report_.frames_wanted = options_.frames;
  report_.endless = options_.endless;
  if (!options_.serve.empty()) report_.served = serve_desc(options_);
  report_.followed = options_.follow;
  if (live_ != nullptr) {
    real_time_.emplace(options_.real_time, [this](std::int64_t due_ns) { live_->wait(simulation_, due_ns); });
    live_->control(*real_time_);
  } else if (options_.real_time > 0) {
    real_time_.emplace(options_.real_time);
  }
  report_.sensors = simulation_.sensors();
  RunRecord& record = report_.record;
  record.command = options_.command;
  record.set = options_.set;
  record.trajectory = options_.trajectory;
  const std::span<const std::filesystem::path> inputs = simulation_.diagnostics().inputs();
  std::vector<std::filesystem::path> files(inputs.begin(), inputs.end());
  files.insert(files.end(), options_.plugins.begin(), options_.plugins.end());
  record.inputs = hashes_of(files);
  if (!options_.trajectory.empty()) record.inputs[options_.trajectory] = sha256_of(options_.trajectory);
  record.environment = simulation_.diagnostics().environment();
  record.host = host_info();
  in_option("--format", [&] { record.formats = parse_formats(options_.formats); });
  record.formats.depth_unit_m = options_.depth_unit_m;
  record.poses = options_.poses;
  for (const SensorInfo& sensor : report_.sensors) {
    const Command& command = simulation_.diagnostics().command(sensor.name);
    record.attributes[sensor.name] = given_attributes(command);
    record.defaults[sensor.name] = default_attributes(command);
  }
}

bool Run::prepare() {
  if (options_.writes && !prepare_folder()) return false;
  views_.emplace(options_.export_file, options_.page);
  if (!options_.profile.empty()) profile_.emplace(options_.profile, report_.device.name);
  return true;
}

bool Run::prepare_folder() {
  const std::filesystem::path file = report_file(options_, report_);
  make_folder(options_.out);
  lock_.emplace(options_.out, report_.shard.has_value());
  if (report_.shard && std::filesystem::exists(std::filesystem::path(options_.out) / "run.json")) {
    throw InputError("--shard: " + options_.out + " has the results of a whole run, expected another --out");
  }
  earlier_ = find_earlier_run(file);
  std::set<std::filesystem::path> folders{options_.out};
  if (earlier_) {
    for (const std::filesystem::path& each : written_files(*earlier_, suffix())) folders.insert(each.parent_path());
  }
  for (const std::filesystem::path& folder : folders) remove_leftovers(folder, report_.shard.has_value());
  if (earlier_ && options_.no_replace) {
    throw InputError("--no-replace: " + file.string() + " is of an earlier run, expected another --out");
  }
  resumes_ = options_.resume && earlier_;
  if (resumes_) {
    go_on(*earlier_);
    if (first_frame_ >= options_.frames) return false;
  }
  AtomicFile probe(file);  // reports an unwritable folder before the first frame
  return true;
}

// Follows the first frame: a run that cannot make it leaves the results of the earlier run alone.
void Run::begin_output() {
  if (earlier_ && !resumes_) replace(*earlier_);
  write_report();
  open_writer();
}

void Run::go_on(const EarlierRun& earlier) {
  in_option("--resume", [&] { require_same_run(earlier, depends_on(to_json(report_))); });
  report_.next_frame = first_frame_ = first_missing_frame(earlier, suffix());
  if (first_frame_ > options_.frames) {
    throw InputError("--resume: the run has " + std::to_string(first_frame_) + " frames, expected --frames " +
                     std::to_string(first_frame_) + " or more");
  }
  report_.files = earlier.files;
  if (first_frame_ == options_.frames && !options_.quiet) {
    std::cout << "the run in " << options_.out << " has all of its " << options_.frames << " frames\n";
  }
}

void Run::replace(const EarlierRun& earlier) {
  const std::size_t removed = remove_results(earlier, suffix());
  if (!options_.quiet) {
    std::cout << "replaced the results of an earlier run in " << options_.out << " (" << removed << " files)\n";
  }
}

void Run::open_writer() {
  OutputDesc desc{.folder = options_.out,
                  .parts = options_.poses,
                  .suffix = suffix(),
                  .threads = options_.threads,
                  .formats = report_.record.formats};
  for (const SensorInfo& sensor : report_.sensors) {
    if (sensor.enabled) desc.sensors.push_back(sensor.name);
  }
  if (resumes_) desc.resume_at = first_frame_;
  desc.on_new_file = [this](const RunFiles& files) {
    if (!resumes_) report_.files.clear();
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
    report_.simulated_s *= static_cast<double>(report_.frame_ms.size()) / static_cast<double>(options_.frames);
  }
  if (real_time_ && real_time_->factor() > 0) report_.real_time = {real_time_->factor(), real_time_->punctuality()};
  report_.wall_s = static_cast<double>(now_ns() - start_ns_) / 1e9;
  write_file(report_file(options_, report_), to_json(report_));
}

/// Computes and writes the frames until a signal comes. Resets `loading` after the first frame.
void Run::make_frames(std::optional<LoadingBar>& loading, WarningPrinter& warnings) {
  const Shard shard = report_.shard.value_or(Shard{});
  ProgressBar progress(std::cerr, shows_progress(options_) && !options_.endless,
                       shard.share_of(options_.frames) - shard.share_of(first_frame_),
                       std::chrono::steady_clock::now());
  std::set<std::string> names;
  for (const SensorInfo& sensor : report_.sensors) {
    if (sensor.enabled) names.insert(sensor.name);
  }
  written_.start(std::move(names), simulation_);
  const bool skips = first_frame_ == 0 || can_skip(simulation_);
  for (std::uint64_t frame = 0; frame < options_.frames && received_signal() == nullptr; ++frame) {
    FrameTime time = simulation_.next_frame();
    if (trajectory_) trajectory_->apply(static_cast<double>(time.time_ns) / 1e9, simulation_.parameters());
    if (!shard.has(frame) || (frame < first_frame_ && skips)) {
      simulation_.skip_frame();
      continue;
    }
    if (live_ != nullptr) live_->before_frame(simulation_);
    if (real_time_) real_time_->wait(time);
    if (follower_ != nullptr) time = follower_->advance(simulation_).value_or(time);
    if (received_signal() != nullptr) break;
    if (views_->any() || live_ != nullptr) read_all_pictures(simulation_);  // a follower may have built it anew
    if (frame >= first_frame_) begin_recording();
    const std::int64_t start_ns = now_ns();
    if (!step()) {
      --frame;  // it is tried again
      continue;
    }
    const std::int64_t measured_ns = now_ns();
    loading.reset();
    warnings.print_new(simulation_);
    if (frame < first_frame_) continue;
    report_.frame_ms.push_back(static_cast<double>(measured_ns - start_ns) / 1e6);
    views_->add(simulation_, time, report_.frame_ms.back());
    if (live_ != nullptr) live_->after_frame(simulation_, time, report_.frame_ms.back());
    if (options_.writes) write_frame(time);
    if (report_.frame_ms.size() == 1) first_done_ns_ = now_ns();
    report_.next_frame = frame + 1;
    if (profile_) add_frame(*profile_, frame, simulation_);
    progress.update(report_.frame_ms.size(), std::chrono::steady_clock::now());
  }
}

/// Returns false if the frame could not be made because of what a client of the live view has changed.
bool Run::step() {
  try {
    follower_ != nullptr ? follower_->step(simulation_) : simulation_.step();
  } catch (const InputError& error) {
    if (live_ == nullptr || !live_->takes_blame(error, simulation_)) throw;
    return false;
  }
  return true;
}

void Run::write_frame(const FrameTime& time) {
  if (!writer_) begin_output();
  if (follower_ == nullptr) written_.follow(simulation_);
  write_results(options_, simulation_, written_, time, *writer_);
}

// Frames that a resumed run makes again are not recorded.
void Run::begin_recording() {
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

void Run::finish() {
  if (options_.writes) {
    if (!writer_ && received_signal() != nullptr) return;
    if (!writer_) begin_output();
  }
  if (options_.explain && received_signal() == nullptr) print_explanation(simulation_);
  if (writer_) writer_->finish();
  if (report_.frame_ms.size() > 1) report_.later_frames_s = static_cast<double>(now_ns() - first_done_ns_) / 1e9;
  if (recording_) report_.recording = simulation_.finish_recording();
  if (options_.dds) report_.dds = simulation_.leave_dds();
  if (profile_) profile_->commit();
  views_->finish(simulation_);
  if (received_signal() == nullptr) report_.next_frame = options_.frames;
  report_.status = report_.next_frame == options_.frames ? "complete" : "stopped";
  if (!options_.writes) return;
  close_sensors();
  write_report();
  if (!options_.quiet) print_closing(options_, *writer_, report_);
}

/// The report names the sensors of the scene file, also those that were removed meanwhile.
void Run::close_sensors() {
  const std::vector<SensorInfo> now = with_bounds(simulation_);
  for (SensorInfo& sensor : report_.sensors) {
    const auto found = std::ranges::find(now, sensor.name, &SensorInfo::name);
    if (written_.contains(sensor.name) && found != now.end()) sensor = *found;
    if (sensor.enabled) sensor.frames = writer_->frames(sensor.name);
  }
}

void Run::fail() {
  if (!writer_) return;
  try {
    writer_->finish();
  } catch (const Error&) {  // the exception that ended the run is the one to report
  }
  try {
    report_.status = "failed";
    write_report();
  } catch (const Error&) {  // as on a full disk: the report then says "running", as after a kill
  }
}

/// Says in what the device and the program differ from those of the run that is made again.
void print_differences(const EarlierRun& run, const RunReport& report) {
  const std::map<std::string, std::string> now = depends_on(to_json(report));
  for (const char* const key : {"device", "driver", "versions"}) {
    const auto before = run.depends.find(key);
    if (before == run.depends.end() || before->second == now.at(key)) continue;
    std::cerr << "warning: " << run.report.string() << ": " << key << " was " << before->second << " and is "
              << now.at(key) << ", so the results may differ\n";
  }
}

}  // namespace

int run_scene(Options options, std::int64_t start_ns) {
  std::optional<EarlierRun> again;
  if (!options.again.empty()) {
    again = read_report(options.again);
    in_option("--again", [&] { require_same_inputs(*again); });
  }
  std::optional<LoadingBar> loading;
  loading.emplace(std::cerr, shows_progress(options));
  std::optional<Follower> follower;
  if (!options.follow.empty()) {
    defer_signals();
    in_option("--follow", [&] { follower.emplace(options.follow, options.scene, scene_desc(options)); });
  }
  Simulation simulation = follower ? follower->open() : load(options, loading);
  loading->clear_line();
  WarningPrinter warnings(std::cerr);
  warnings.print_new(simulation);
  const std::optional<Trajectory> trajectory = read_trajectory(options, simulation);
  warnings.print_new(simulation);
  if (trajectory && !options.names_frames) options.frames = frames_of(*trajectory, options, simulation);
  for (const std::string& part : options.poses) {
    in_option("--poses", [&] { simulation.track_part(part); });
  }
  if (options.endless) options.frames = std::numeric_limits<std::uint64_t>::max();
  if (!options.serve.empty()) {
    in_option("--serve", [&] { simulation.serve(serve_desc(options)); });
    if (!options.quiet) std::cout << "served as " << options.serve << std::endl;
  }
  if (options.dds) {
    in_option("--dds", [&] { simulation.join_dds(dds_desc(options)); });
  }
  std::optional<LiveRun> live;
  if (options.live) {
    in_option("--live", [&] { live.emplace(options, simulation, follower ? &*follower : nullptr); });
    std::cout << live->links() << std::endl;
  }
  Run run(options, simulation, trajectory, follower ? &*follower : nullptr, live ? &*live : nullptr, start_ns);
  if (again) print_differences(*again, run.report());
  defer_signals();
  if (!run.prepare()) return 0;
  try {
    run.make_frames(loading, warnings);
    loading.reset();
    run.finish();
  } catch (...) {
    run.fail();
    throw;
  }
  if (const char* const signal = received_signal(); signal != nullptr && run.report().status != "complete") {
    std::cerr << "simvis-run: stopped by a signal (" << signal << ") before frame " << run.report().next_frame;
    if (!options.endless) std::cerr << " of " << options.frames << "; --resume goes on";
    std::cerr << '\n';
    return kExitStopped;
  }
  if (options.summary) print_summary(options, std::move(simulation), trajectory, run.report());
  return 0;
}

}  // namespace simvis
