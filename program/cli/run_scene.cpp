#include "program/cli/run_scene.h"

#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <simvis/simulation.h>
#include <simvis/trajectory.h>
#include "program/cli/follower.h"
#include "program/cli/live_run.h"
#include "program/cli/load_scene.h"
#include "program/cli/loading_bar.h"
#include "program/cli/run.h"
#include "program/cli/run_messages.h"
#include "program/cli/signals.h"
#include "program/cli/warning_printer.h"
#include "program/options/command_line.h"
#include "program/report/earlier_run.h"

namespace simvis {
namespace {

/// Empty without --again.
std::optional<EarlierRun> run_to_repeat(const Options& options) {
  std::optional<EarlierRun> run;
  if (options.again.empty()) return run;
  run = read_report(options.again);
  in_option("--again", [&] { require_same_inputs(*run); });
  return run;
}

/// Empty without --follow.
std::optional<Follower> follower_of(const Options& options) {
  std::optional<Follower> follower;
  if (options.follow.empty()) return follower;
  defer_signals();
  in_option("--follow", [&] { follower.emplace(options.follow, options.scene, scene_desc(options)); });
  return follower;
}

void print_reach(const DdsReach& reach, const DdsDesc& desc) {
  std::cout << "DDS: domain " << reach.domain;
  if (reach.is_local) {
    std::cout << " on this machine alone; its programs";
  } else {
    std::cout << " on";
    for (const std::string& interface : reach.interfaces) std::cout << ' ' << interface;
    std::cout << "; programs of every network that reaches this machine";
  }
  std::cout << " may set parameters and command robots, change requests are "
            << (desc.requests ? "executed" : "refused without --dds-requests") << std::endl;
}

/// --poses, --serve and --dds.
void prepare_simulation(const Options& options, Simulation& simulation) {
  for (const std::string& part : options.poses) {
    in_option("--poses", [&] { simulation.track_part(part); });
  }
  if (!options.serve.empty()) {
    in_option("--serve", [&] { simulation.serve(serve_desc(options)); });
    if (!options.quiet) std::cout << "served as " << options.serve << std::endl;
  }
  if (options.dds) {
    const DdsDesc desc = dds_desc(options);
    in_option("--dds", [&] {
      const DdsReach reach = simulation.join_dds(desc);
      if (!options.quiet) print_reach(reach, desc);
    });
  }
}

/// Returns the exit status.
int stopped_by(const char* signal, const Options& options, const RunReport& report) {
  std::cerr << "simvis-run: stopped by a signal (" << signal << ") before frame " << report.next_frame;
  if (!options.endless) std::cerr << " of " << options.frames;
  std::cerr << (is_shared(options) ? "\n" : "; --resume goes on\n");
  return kExitStopped;
}

}  // namespace

int run_scene(Options options, std::int64_t start_ns) {
  const std::optional<EarlierRun> again = run_to_repeat(options);
  std::optional<LoadingBar> loading;
  loading.emplace(std::cerr, shows_progress(options));
  std::optional<Follower> follower = follower_of(options);
  Follower* const followed = follower ? &*follower : nullptr;
  Simulation simulation = follower ? follower->open() : load(options, loading);
  loading->clear_line();
  WarningPrinter warnings(std::cerr);
  warnings.print_new(simulation);
  const std::optional<Trajectory> trajectory = read_trajectory(options, simulation);
  warnings.print_new(simulation);
  if (trajectory && !options.names_frames) options.frames = frames_of(*trajectory, simulation);
  if (options.endless) options.frames = std::numeric_limits<std::uint64_t>::max();
  prepare_simulation(options, simulation);
  RunControl control(options.real_time);
  std::unique_ptr<LiveRun> live;
  if (options.live) {
    in_option("--live", [&] { live = std::make_unique<LiveRun>(options, simulation, control, followed); });
    std::cout << live->links() << std::endl;
  }
  Run run(options, simulation, control, trajectory, followed, std::move(live), start_ns);
  if (again) print_differences(*again, run.report());
  defer_signals();
  if (!run.prepare()) return 0;
  try {
    run.make_frames(loading, warnings);
    loading.reset();
    run.finish(warnings);
  } catch (...) {
    run.fail();
    throw;
  }
  const char* const signal = received_signal();
  if (signal != nullptr && run.report().status != "complete") return stopped_by(signal, options, run.report());
  if (options.summary) print_summary(options, std::move(simulation), trajectory, run.report());
  return 0;
}

}  // namespace simvis
