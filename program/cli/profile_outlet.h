// The profile of a run, for --profile.
#pragma once

#include <memory>

#include <simvis/simulation.h>
#include "program/cli/run_outlet.h"
#include "program/options/options.h"

namespace simvis {

/// Gets each frame after the outlets whose time it shows as "write". Errors: as Profile, and name the option.
std::unique_ptr<RunOutlet> profile_outlet(const Options& options, const Simulation& simulation);

}  // namespace simvis
