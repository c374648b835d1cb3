// The run of one command line, from the loaded scene to its report.
#pragma once

#include <cstdint>
#include <exception>
#include <optional>
#include <set>
#include <string>

#include <simvis/simulation.h>
#include <simvis/trajectory.h>
#include "program/cli/dataset_run.h"
#include "program/cli/follower.h"
#include "program/cli/live_run.h"
#include "program/cli/loading_bar.h"
#include "program/cli/real_time.h"
#include "program/cli/run_folder.h"
#include "program/cli/view_files.h"
#include "program/cli/warning_printer.h"
#include "program/cli/written_sensors.h"
#include "program/options/options.h"
#include "program/output/output_writer.h"
#include "program/report/profile.h"
#include "program/report/run_report.h"

namespace simvis {

class Run {
 public:
  /// The objects outlive it. `follower` is null unless the frames are those of another process.
  /// `live` is null without --live.
  Run(const Options& options, Simulation& simulation, const std::optional<Trajectory>& trajectory, Follower* follower,
      LiveRun* live, std::int64_t start_ns);

  /// Takes the folder and what an earlier run left in it. Returns false if there is nothing left to do.
  bool prepare();
  /// Computes and writes the frames until a signal comes. Resets `loading` after the first frame.
  void make_frames(std::optional<LoadingBar>& loading, WarningPrinter& warnings);
  void finish();
  /// After an exception: keeps what is whole and says in the report that the run failed, if that is still possible.
  void fail();
  const RunReport& report() const { return report_; }

 private:
  void begin_clock();
  void begin_output();
  void open_writer();
  void begin_recording();
  void begin_packets();
  bool begin_dataset();
  void write_report();
  void end_recordings();
  void close_sensors();
  std::set<std::string> enabled_sensors() const;
  std::optional<FrameTime> next_time();
  std::optional<FrameTime> follow();
  bool step();
  void keep(const FrameTime& time, double step_ms);
  void write_frame(const FrameTime& time);
  std::string suffix() const { return report_.shard ? report_.shard->suffix() : ""; }

  const Options& options_;
  Simulation& simulation_;
  const std::optional<Trajectory>& trajectory_;
  Follower* follower_;
  LiveRun* live_;
  std::int64_t start_ns_;
  RunReport report_;
  std::int64_t first_done_ns_ = 0;  // end of the first frame of this process
  bool recording_ = false, packets_begun_ = false;
  std::exception_ptr outlet_failure_;  // ends the run once its frame is kept
  std::optional<RunFolder> folder_;    // empty: nothing is written
  std::optional<Profile> profile_;
  std::optional<OutputWriter> writer_;
  WrittenSensors written_;
  std::optional<RealTime> real_time_;
  std::optional<ViewFiles> views_;
  std::optional<DatasetRun> dataset_;  // with --dataset, in place of the folder and its writer
};

}  // namespace simvis
