// The datasets of a run, for --dataset.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <simvis/simulation.h>
#include "program/cli/run_outlet.h"
#include "program/datasets/dataset_folder.h"
#include "program/options/options.h"
#include "program/report/run_report.h"

namespace simvis {

class DatasetRun : public RunOutlet {
 public:
  /// The objects outlive it. Throws what DatasetFolder throws.
  DatasetRun(const Options& options, const RunReport& report, Simulation& simulation);

  /// Whether each dataset has the frame.
  bool has(std::uint64_t frame) const;
  bool has_all() const;
  /// Throws InputError for a warning of a format if the simulation is strict.
  void frame(const FrameTime& time) override;
  /// Writes the files of the wholes that lack no frame, and says so.
  void finish() override;

 private:
  const Options& options_;
  Simulation& simulation_;
  std::vector<std::unique_ptr<DatasetFolder>> folders_;  // as Options::datasets
};

}  // namespace simvis
