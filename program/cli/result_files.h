// The files of results of a run, and its report, run.json.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include <simvis/simulation.h>
#include "program/cli/run_folder.h"
#include "program/cli/run_outlet.h"
#include "program/cli/written_sensors.h"
#include "program/options/options.h"
#include "program/output/output_writer.h"
#include "program/report/run_report.h"

namespace simvis {

class ResultFiles : public RunOutlet {
 public:
  /// Takes the folder and what an earlier run left in it; see RunFolder. The objects outlive it. `update` brings the
  /// report up to date before it is written.
  ResultFiles(const Options& options, const Simulation& simulation, RunReport& report, std::function<void()> update);

  const RunFolder& folder() const { return folder_; }
  /// Replaces the results of an earlier run, unless that is done. The first frame does so too: a run that cannot make
  /// it leaves them alone.
  void open();
  bool is_open() const { return writer_.has_value(); }

  void frame(const FrameTime& time) override;
  void finish() override;
  void fail() override;

  void write_report();
  /// The measurements written; see OutputWriter::results().
  const std::vector<std::string>& results() const { return writer_->results(); }

 private:
  OutputDesc output_desc();
  void add_files(const RunFiles& files);
  void close_sensors();

  const Options& options_;
  const Simulation& simulation_;
  RunReport& report_;
  std::function<void()> update_;
  RunFolder folder_;
  std::optional<OutputWriter> writer_;
  WrittenSensors written_;
};

}  // namespace simvis
