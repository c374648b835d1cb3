// Reads the command line of simvis-run by the table of options.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "program/options/options.h"
#include "program/report/earlier_run.h"

namespace simvis {

/// Options, or the exit status of a program that has already printed what was asked for: its help, its version.
struct ParsedOptions {
  Options options;
  std::optional<int> exit_status;
  std::vector<std::string> warnings{};  ///< of what is taken as it stands, and is a mistake perhaps
};

/// `arguments` without the program's name. Throws InputError.
ParsedOptions parse_options(std::vector<std::string> arguments);

/// Returns whether other processes take part in a run of these options.
bool is_shared(const Options& options);

/// Throws InputError if other processes took part in the run: what they did is not recorded, so the run can neither be
/// made again nor go on.
void require_own_run(const EarlierRun& run);

struct RecordedOptions {
  Options options;
  std::vector<std::string> warnings;  ///< of what the report has and the run does not follow
};

/// The options of the run that --again names, or that --resume without a scene goes on with, with those of `given` that
/// change no result (OptionSpec::changes_no_result), such as --out, and --frames for --resume. Who wrote the report
/// chooses no code: plug-ins are those of `given`, and of the recorded environment only recorded_variables() are set.
/// Throws InputError: the report cannot be read, an option is given that the run has fixed, or its plug-ins are not
/// named again.
RecordedOptions recorded_options(Options given);

}  // namespace simvis
