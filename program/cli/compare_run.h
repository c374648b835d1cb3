// The option --compare: a recording of a real scanner against the scene.
#pragma once

#include "program/options/options.h"

namespace simvis {

/// Prints the report, and writes it to --out where that is given. Throws InputError.
void compare_with_recording(const Options& options);

}  // namespace simvis
