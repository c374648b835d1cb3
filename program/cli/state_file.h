// The state of a simulation as a file: --save-state.
#pragma once

#include <memory>

#include <simvis/simulation.h>
#include "program/cli/run_outlet.h"
#include "program/options/options.h"

namespace simvis {

/// Writes the state after the last frame to the file of --save-state. The file appears with finish(), or not at all.
/// Throws InputError, with the option's name, if Simulation::save_state() does so now.
std::unique_ptr<RunOutlet> state_outlet(const Options& options, Simulation& simulation);

}  // namespace simvis
