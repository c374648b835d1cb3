// The run of one command line, from the loaded scene to its report.
#pragma once

#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <vector>

#include <simvis/simulation.h>
#include <simvis/trajectory.h>
#include "program/cli/dataset_run.h"
#include "program/cli/follower.h"
#include "program/cli/live_run.h"
#include "program/cli/loading_bar.h"
#include "program/cli/real_time.h"
#include "program/cli/result_files.h"
#include "program/cli/run_outlet.h"
#include "program/cli/warning_printer.h"
#include "program/options/options.h"
#include "program/report/run_report.h"
#include "simvis/sharing/run_control.h"
#include "simvis/sharing/simulation_services.h"

namespace simvis {

class Run {
 public:
  /// The objects outlive it. `follower` is null unless the frames are those of another process.
  /// `live` is null without --live.
  Run(const Options& options, Simulation& simulation, RunControl& control, const std::optional<Trajectory>& trajectory,
      Follower* follower, std::unique_ptr<LiveRun> live, std::int64_t start_ns);
  ~Run();

  /// Adds the outlets. Returns false if an earlier run left nothing to do.
  bool prepare();
  /// Computes and writes the frames until a signal comes. Resets `loading` after the first frame.
  void make_frames(std::optional<LoadingBar>& loading, WarningPrinter& warnings);
  /// Prints what outlets warn of at their end.
  void finish(WarningPrinter& warnings);
  /// After an exception: keeps what is whole and says in the report that the run failed, if that is still possible.
  void fail();
  const RunReport& report() const { return report_; }

 private:
  template <typename Outlet>
  Outlet* add(std::unique_ptr<Outlet> outlet);
  void begin_clock();
  void begin_services();
  void begin_outlets();
  void update_report();
  void serve_clients();
  void wait_for_clients(std::int64_t due_ns);
  void await_turn();
  void apply_trajectory();
  std::optional<FrameTime> next_time();
  std::optional<FrameTime> follow();
  bool step();
  void keep(const FrameTime& time, double step_ms);

  const Options& options_;
  Simulation& simulation_;
  RunControl& control_;
  const std::optional<Trajectory>& trajectory_;
  Follower* follower_;
  std::int64_t start_ns_;
  RunReport report_;
  std::int64_t first_done_ns_ = 0;  // end of the first frame of this process
  std::optional<RealTime> real_time_;
  std::uint64_t restarts_ = 0;         // of control_, that real_time_ follows
  std::exception_ptr outlet_failure_;  // of the simulation's own ones; ends the run once its frame is kept
  std::vector<std::unique_ptr<RunOutlet>> outlets_;
  bool outlets_begun_ = false;
  bool is_whole_ = false;  // no frame is missing; a signal that comes later changes nothing
  // Outlets of the list; null: not there.
  LiveRun* live_ = nullptr;
  ResultFiles* files_ = nullptr;
  DatasetRun* dataset_ = nullptr;  // in place of `files_`
  std::optional<SimulationServices> services_;
};

}  // namespace simvis
