// Runs a scene: makes its frames and writes what its sensors measure.
#pragma once

#include <cstdint>

#include "program/options/options.h"

namespace simvis {

/// Returns the exit status: 0, or kExitStopped if a signal came. `start_ns`: when the program began.
int run_scene(Options options, std::int64_t start_ns);

}  // namespace simvis
