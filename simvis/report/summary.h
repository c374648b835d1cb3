// What a run was worth, in a few lines for people: speed of the scanners, the cameras' share, what accuracy costs, and
// what to look at.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include <simvis/trajectory.h>
#include "simvis/report/price.h"

namespace simvis {

struct SummaryDesc {
  double rate_hz = SimulationDesc{}.rate_hz;  ///< of the run: what scanners are compared with
  double frame_ms = 0;                        ///< the median frame of the run, in which all its sensors measured
  std::filesystem::path out{};                ///< the folder of the run's results
  const Trajectory* trajectory = nullptr;
  std::function<void()> on_frame{};  ///< called after every frame; what it throws ends the summary
};

/// Times are medians of frames.
struct RunSummary {
  std::size_t scanners = 0;                    ///< that measure together in one set; 0: none do
  std::uint64_t beams = 0;                     ///< of all of them
  double set_ms = 0;                           ///< of a frame in which only the scanners measure
  double rate_hz = 0;                          ///< of the run
  double frame_ms = 0;                         ///< of the run
  std::size_t cameras = 0;                     ///< sensors that are no laser scanners
  std::optional<ScannerPrice> price{};         ///< of the first scanner, by variants_by_method()
  std::vector<std::filesystem::path> files{};  ///< to open first; all of them exist
};

/// Measures the scanners that are enabled once more, which uses up the simulation. Scanners that stand in a part that
/// is switched off are left out.
RunSummary summarize(Simulation simulation, const SummaryDesc& desc);

/// The largest error of a variant in metres: what it says where `raycast` says otherwise, or the bound of `raycast`.
double largest_error_m(const ScannerPrice& price, const VariantPrice& variant);

/// Lines, each with its end.
std::string to_text(const RunSummary& summary);

}  // namespace simvis
