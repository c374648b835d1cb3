// The environment variables that a run records.
#pragma once

#include <span>

#include "engine/base/program_api.h"

namespace simvis {

/// The variables that lead to packages and models. They name folders that are searched, and no code. A run's report has
/// them alone, and a run that is made again takes no others from a report.
SIMVIS_PROGRAM_API std::span<const char* const> recorded_variables();

}  // namespace simvis
