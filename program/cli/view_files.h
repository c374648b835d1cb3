// What a run writes for people to look at: --export and --page.
#pragma once

#include <memory>

#include <simvis/simulation.h>
#include "program/cli/run_outlet.h"
#include "program/options/options.h"

namespace simvis {

/// The scene after the last frame as a GLB, or as a map (program/cli/map_outlet.h), and all frames as a page. Each file
/// appears with finish(), or not at all; of a folder that was made for a file that does not appear, nothing is left.
/// Errors: MachineError, also of these functions, with the option's name before that of InputError.
std::unique_ptr<RunOutlet> export_outlet(const Options& options, Simulation& simulation);
std::unique_ptr<RunOutlet> page_outlet(const Options& options, Simulation& simulation);

}  // namespace simvis
