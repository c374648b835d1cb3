// A short summary of a run: the speed of the scanners, the share of the cameras, the cost of accuracy, and the files to
// open first.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include <simvis/trajectory.h>
#include "program/report/scanner_costs.h"

namespace simvis {

struct SummaryDesc {
  double rate_hz = SimulationDesc{}.rate_hz;  ///< rate of the run, with which the speed of the scanners is compared
  double frame_ms = 0;                        ///< median time of a frame of the run, in which all sensors measured
  std::size_t later_frames = 0;               ///< frames of the run after the first one
  double later_frames_s = 0;                  ///< wall clock of these frames until their last file was written
  std::filesystem::path out{};                ///< the folder of the run's results
  const Trajectory* trajectory = nullptr;
  std::function<void()> on_frame{};  ///< called after every frame; an exception from it ends the summary
};

/// Times are medians over frames.
struct RunSummary {
  std::size_t scanners = 0;                    ///< number of scanners that measure together in one set; may be 0
  std::uint64_t beams = 0;                     ///< total of all scanners of the set
  double set_ms = 0;                           ///< time of a frame in which only the scanners measure
  double rate_hz = 0;                          ///< rate of the run
  double frame_ms = 0;                         ///< time of a frame of the run
  double wall_hz = 0;                          ///< frames per second with their files after the first one; 0: none
  std::size_t cameras = 0;                     ///< number of sensors that cast no beams
  std::optional<ScannerCosts> costs{};         ///< of the first scanner, for ScanVariants::by_method
  std::vector<std::filesystem::path> files{};  ///< files to open first; all of them exist
};

/// Measures the enabled scanners again and consumes the simulation. Scanners that are mounted in a part that is
/// switched off are left out.
RunSummary summarize(Simulation simulation, const SummaryDesc& desc);

/// The largest error in metres of the beams for which a variant has a finite error bound: their largest difference to
/// `raycast`, but at least the bound of `raycast`. Where `raycast` is no variant: its own bound.
double bounded_error_m(const ScannerCosts& costs, const VariantCosts& variant);

/// The summary as lines, each with a line end.
std::string to_text(const RunSummary& summary);

}  // namespace simvis
