#include "program/cli/run.h"

#include <algorithm>
#include <chrono>
#include <iostream>
#include <utility>
#include <vector>

#include "engine/base/now_ns.h"
#include "program/cli/begin_report.h"
#include "program/cli/load_scene.h"
#include "program/cli/memory_reserve.h"
#include "program/cli/profile_outlet.h"
#include "program/cli/progress_bar.h"
#include "program/cli/run_messages.h"
#include "program/cli/signals.h"
#include "program/cli/simulation_outlets.h"
#include "program/cli/state_file.h"
#include "program/cli/view_files.h"
#include "program/report/shard.h"
#include "simvis/built_scene.h"

namespace simvis {
namespace {

// A paused or waiting run looks for signals, and for requests of services.
constexpr std::int64_t kSignalPeriod_ns = 50'000'000, kServicePeriod_ns = 10'000'000;

/// Whether frames before the first one of this process can be skipped. Otherwise they are made again.
bool can_skip(const Simulation& simulation) {
  try {
    simulation.require_skippable();
    return true;
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace

Run::Run(const Options& options, Simulation& simulation, RunControl& control,
         const std::optional<Trajectory>& trajectory, Follower* follower, std::unique_ptr<LiveRun> live,
         std::int64_t start_ns)
    : options_(options),
      simulation_(simulation),
      control_(control),
      trajectory_(trajectory),
      follower_(follower),
      start_ns_(start_ns),
      report_(begin_report(options, simulation)) {
  if (live != nullptr) live_ = add(std::move(live));
  begin_clock();
}

// The folder of results goes after what may have made files in it.
Run::~Run() {
  while (!outlets_.empty()) outlets_.pop_back();
}

template <typename Outlet>
Outlet* Run::add(std::unique_ptr<Outlet> outlet) {
  Outlet* const added = outlet.get();
  outlets_.push_back(std::move(outlet));
  return added;
}

void Run::begin_clock() {
  const bool has_clients = live_ != nullptr || options_.dds;
  if (has_clients) {
    real_time_.emplace(options_.real_time, [this](std::int64_t due_ns) {
      serve_clients();
      wait_for_clients(due_ns);
    });
  } else if (options_.real_time > 0) {
    real_time_.emplace(options_.real_time);
  }
}

// A scene of another process is changed and stepped there.
void Run::begin_services() {
  if (!options_.dds || follower_ != nullptr) return;
  apply_trajectory();  // the state to which a reset returns has its first values
  const bool can_go_back = options_.serve.empty() && std::ranges::all_of(outlets_, &RunOutlet::can_go_back);
  services_.emplace(simulation_, control_,
                    SimulationServicesDesc{.changes = options_.dds_requests,
                                           .resets = can_go_back,
                                           .folders = request_folders(options_),
                                           .quit = ask_to_stop});
}

bool Run::prepare() {
  require_replaceable(options_);
  if (options_.writes) {
    files_ = add(std::make_unique<ResultFiles>(options_, simulation_, report_, [this] { update_report(); }));
    if (files_->folder().is_complete()) return false;
  }
  if (!options_.datasets.empty()) {
    dataset_ = add(std::make_unique<DatasetRun>(options_, report_, simulation_));
    if (dataset_->has_all()) {
      dataset_->finish();  // a run that was killed may lack the files of the whole
      return false;
    }
  }
  for (std::unique_ptr<RunOutlet>& each : simulation_outlets(options_, simulation_, report_)) add(std::move(each));
  if (!options_.export_file.empty()) add(export_outlet(options_, simulation_));
  if (!options_.page.empty()) add(page_outlet(options_, simulation_));
  if (!options_.save_state.empty()) add(state_outlet(options_, simulation_));
  if (!options_.profile.empty()) add(profile_outlet(options_, simulation_));
  begin_services();
  return true;
}

void Run::begin_outlets() {
  if (std::exchange(outlets_begun_, true)) return;
  for (const std::unique_ptr<RunOutlet>& outlet : outlets_) outlet->begin();
}

void Run::update_report() {
  report_.warnings = simulation_.warnings();
  report_.simulated_s = static_cast<double>(simulation_.next_frame().time_ns) / 1e9;
  if (!options_.endless) {
    const auto next = static_cast<double>(std::max<std::uint64_t>(simulation_.next_frame().index, 1));
    report_.simulated_s *= static_cast<double>(report_.frame_ms.added()) / next;
  }
  if (real_time_ && real_time_->factor() > 0) report_.real_time = {real_time_->factor(), real_time_->punctuality()};
  report_.wall_s = static_cast<double>(now_ns() - start_ns_) / 1e9;
}

void Run::make_frames(std::optional<LoadingBar>& loading, WarningPrinter& warnings) {
  const std::uint64_t first_frame = files_ != nullptr ? files_->folder().first_frame() : 0;
  const Shard shard = report_.shard.value_or(Shard{});
  ProgressBar progress(std::cerr, shows_progress(options_) && !options_.endless,
                       shard.share_of(options_.frames) - shard.share_of(first_frame), std::chrono::steady_clock::now());
  const bool skips = (first_frame == 0 && dataset_ == nullptr) || can_skip(simulation_);
  const auto is_made = [&](std::uint64_t frame) {
    return frame < first_frame || (dataset_ != nullptr && dataset_->has(frame));
  };
  const auto is_skipped = [&](std::uint64_t frame) { return !shard.has(frame) || (is_made(frame) && skips); };
  std::uint64_t frame = 0;
  while (frame < options_.frames && received_signal() == nullptr) {
    if (is_skipped(frame)) {
      apply_trajectory();
      simulation_.skip_frame();
      ++frame;
      continue;
    }
    const std::uint64_t expected = simulation_.next_frame().index;
    const std::optional<FrameTime> time = next_time();
    if (!time) break;
    if (services_ && time->index < expected) report_.next_frame = frame = 0;  // a reset
    if (frame >= first_frame) begin_outlets();
    apply_trajectory();
    const std::int64_t start_ns = now_ns();
    if (!step()) continue;  // it is tried again
    const double step_ms = static_cast<double>(now_ns() - start_ns) / 1e6;
    loading.reset();
    warnings.print_new(simulation_);
    if (++frame > first_frame) {  // otherwise it was made again for the frames that follow
      keep(*time, step_ms);
      report_.next_frame = frame;
      progress.update(report_.frame_ms.added(), std::chrono::steady_clock::now());
    }
    if (outlet_failure_) std::rethrow_exception(outlet_failure_);
    require_memory();
  }
  while (frame < options_.frames && is_skipped(frame)) ++frame;  // a signal came behind the last one that is made
  is_whole_ = frame >= options_.frames;
}

/// Called just before a frame is made or skipped, so that clients of a paused run find the poses of its last frame.
/// Replaces what they have set of these parameters before. What comes while the run plays is taken by the step itself,
/// and is kept for one frame.
void Run::apply_trajectory() {
  if (!trajectory_) return;
  trajectory_->apply(static_cast<double>(simulation_.next_frame().time_ns) / 1e9, simulation_.parameters());
}

void Run::serve_clients() {
  if (live_ != nullptr) live_->serve();
  if (services_) services_->serve();
  if (real_time_ && std::exchange(restarts_, control_.restarts()) != control_.restarts()) {
    real_time_->restart(control_.pace());
  }
}

/// Waits until `due_ns` (clock of now_ns()), or so briefly that no client and no signal waits for long.
void Run::wait_for_clients(std::int64_t due_ns) {
  const std::int64_t slice_ns = services_ ? kServicePeriod_ns : kSignalPeriod_ns;
  const std::int64_t until_ns = std::min(due_ns, now_ns() + slice_ns);
  live_ != nullptr ? live_->wait(until_ns) : RealTime::sleep_until(until_ns);
}

/// Waits while the run is paused, until a signal comes.
void Run::await_turn() {
  serve_clients();
  while (!control_.makes_frame() && received_signal() == nullptr) {
    wait_for_clients(now_ns() + kSignalPeriod_ns);
    serve_clients();
  }
}

/// Waits until the next frame is due, and has its scene. Empty: a signal came.
std::optional<FrameTime> Run::next_time() {
  const std::uint64_t expected = simulation_.next_frame().index;
  do {
    await_turn();
    if (real_time_ && received_signal() == nullptr) real_time_->wait(simulation_.next_frame());
  } while (!control_.makes_frame() && received_signal() == nullptr);
  control_.begin_frame();
  FrameTime time = simulation_.next_frame();
  // After a reset, the run may have waited for the wall clock of a frame that it no longer makes.
  if (time.index < expected && real_time_) real_time_->restart(control_.pace());
  if (follower_ != nullptr) time = follow().value_or(time);
  if (received_signal() != nullptr) return std::nullopt;
  if (std::ranges::any_of(outlets_, &RunOutlet::shows_all_content)) {
    read_all_content(simulation_);  // a follower may have built another one
  }
  return time;
}

/// As Follower::advance(); clients of the live view are served meanwhile.
std::optional<FrameTime> Run::follow() {
  Follower::Waiting serve;
  if (live_ != nullptr) serve = [this](bool has_host) { live_->while_waiting(has_host); };
  return follower_->advance(simulation_, serve);
}

/// Returns false if the frame could not be made because of what a client has changed. The run is then paused.
bool Run::step() {
  try {
    follower_ != nullptr ? follower_->step(simulation_) : simulation_.step();
  } catch (const OutletError&) {
    outlet_failure_ = std::current_exception();
  } catch (const InputError& error) {
    if (!control_.is_changed() && !(services_ && services_->is_changed())) throw;
    control_.pause();
    if (live_ != nullptr) live_->show_failure(error);
    if (!services_) return false;
    services_->end_steps(error.what());
    std::cerr << "simvis-run: paused, since the next frame can't be made: " << error.what() << '\n';
    return false;
  }
  return true;
}

/// Everything that is kept of the frame just made.
void Run::keep(const FrameTime& time, double step_ms) {
  report_.frame_ms.add(step_ms);
  if (services_) services_->follow_frame();
  for (const std::unique_ptr<RunOutlet>& outlet : outlets_) outlet->frame(time);
  if (report_.frame_ms.added() == 1) first_done_ns_ = now_ns();
}

void Run::finish(WarningPrinter& warnings) {
  if (services_) {
    services_->end();
    services_->serve();
  }
  require_memory();
  if (files_ != nullptr) {
    if (!files_->is_open() && !is_whole_) return;
    files_->open();
  }
  if (!is_whole_) SimulationServices::end_early(simulation_);
  if (options_.explain && is_whole_) print_explanation(simulation_);
  warnings.print_new(simulation_);
  for (const std::unique_ptr<RunOutlet>& outlet : outlets_) {
    outlet->finish();
    require_memory();
  }
  warnings.print_new(simulation_);
  if (report_.frame_ms.added() > 1) report_.later_frames_s = static_cast<double>(now_ns() - first_done_ns_) / 1e9;
  if (is_whole_) report_.next_frame = options_.frames;
  report_.status = is_whole_ ? "complete" : "stopped";
  if (files_ == nullptr) return;
  files_->write_report();
  if (!options_.quiet) print_closing(options_, files_->folder().report_file(), files_->results(), report_);
}

void Run::fail() {
  for (const std::unique_ptr<RunOutlet>& outlet : outlets_) {
    try {
      outlet->fail();
    } catch (const std::exception&) {  // the exception that ended the run is the one to report
    }
  }
}

}  // namespace simvis
