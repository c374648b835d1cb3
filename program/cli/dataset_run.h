// The dataset of a run, for --dataset.
#pragma once

#include <cstdint>

#include <simvis/simulation.h>
#include "program/cli/run_outlet.h"
#include "program/datasets/dataset_folder.h"
#include "program/options/options.h"
#include "program/report/run_report.h"

namespace simvis {

class DatasetRun : public RunOutlet {
 public:
  /// The objects outlive it. Throws what DatasetFolder throws.
  DatasetRun(const Options& options, const RunReport& report, const Simulation& simulation);

  bool has(std::uint64_t frame) const { return folder_.has(frame); }
  bool has_all() const { return folder_.has_all(); }
  void frame(const FrameTime& time) override;
  /// Writes the files of the whole if no frame is missing, and says so.
  void finish() override;

 private:
  const Options& options_;
  const Simulation& simulation_;
  DatasetFolder folder_;
};

}  // namespace simvis
