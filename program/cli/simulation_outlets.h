// The outlets of a simulation that a run starts and stops: --record-pcap, --udp, --record and --dds.
#pragma once

#include <memory>
#include <vector>

#include <simvis/simulation.h>
#include "program/cli/run_outlet.h"
#include "program/options/options.h"
#include "program/report/run_report.h"

namespace simvis {

/// Throws InputError with --no-replace if a file or bag is there that the run would write beside its folder.
void require_replaceable(const Options& options);

/// Those that the options name; what they have written goes into `report`. The objects outlive them. Errors name the
/// option.
std::vector<std::unique_ptr<RunOutlet>> simulation_outlets(const Options& options, Simulation& simulation,
                                                           RunReport& report);

}  // namespace simvis
