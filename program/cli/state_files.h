// The state of a simulation in files: --save-state and --restore-state.
#pragma once

#include <memory>

#include <simvis/simulation.h>
#include "program/cli/run_outlet.h"
#include "program/options/options.h"

namespace simvis {

/// Goes on from the state in the file of --restore-state, if that is given. Throws InputError, with the option's name,
/// as Simulation::restore_state().
void restore_state(const Options& options, Simulation& simulation);

/// Writes the state after the last frame to the file of --save-state. The file appears with finish(), or not at all.
/// Throws InputError, with the option's name, if Simulation::save_state() does so now.
std::unique_ptr<RunOutlet> state_outlet(const Options& options, Simulation& simulation);

}  // namespace simvis
