// What the main() of each helper program has in common: it tells SimVis why there is no result.
#pragma once

#include <functional>
#include <string>

#include "import/programs/process_limits.h"
#include "import/sandbox/import_answer.h"

namespace simvis {

/// Limits the process (process_limits.h), calls `work` and reports what it throws: memory that runs out, a MachineError
/// or an error of the operating system that is_fault_of_file() denies as a fault of the machine; everything else as a
/// refusal of the file. The message about memory begins with `takes` and ends with `advice`.
void report_faults(AnswerWriter& answer, const std::string& takes, const std::string& advice,
                   const ProcessLimits& limits, const std::function<void()>& work);

}  // namespace simvis
