// What simvis-run prints about a run.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include <simvis/simulation.h>
#include <simvis/trajectory.h>
#include "program/options/options.h"
#include "program/report/earlier_run.h"
#include "program/report/run_report.h"

namespace simvis {

/// --explain: the plan of the last frame, with what it cost.
void print_explanation(const Simulation& simulation);

/// Which files were written, `results` and `report_file` among them, and how fast.
void print_closing(const Options& options, const std::filesystem::path& report_file,
                   std::span<const std::string> results, const RunReport& report);

/// --summary: how the speed compares with the rate, and what accuracy costs. It makes further frames.
void print_summary(const Options& options, Simulation simulation, const std::optional<Trajectory>& trajectory,
                   const RunReport& report);

/// Warns of what differs in the device and the program from those of the run that is made again.
void print_differences(const EarlierRun& run, const RunReport& report);

}  // namespace simvis
