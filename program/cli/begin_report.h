// The report of a run as its command line and its scene begin it.
#pragma once

#include <simvis/simulation.h>
#include "program/options/options.h"
#include "program/report/run_report.h"

namespace simvis {

/// What the run depends on, before its first frame. Throws InputError: --shard, --format, a file that cannot be read.
RunReport begin_report(const Options& options, const Simulation& simulation);

}  // namespace simvis
