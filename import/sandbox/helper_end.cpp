#include "import/sandbox/helper_end.h"

#include <algorithm>
#include <csignal>
#include <cstring>

#include <simvis/error.h>
#include "engine/base/assert.h"

namespace simvis {
namespace {

// What the program does to itself, or its compiler, its allocator or its system-call filter in its name.
constexpr int kSignalsOfCrashes[] = {SIGSEGV, SIGABRT, SIGFPE, SIGILL, SIGTRAP};

HelperFault killed_by(int signal) {
  const std::string name = std::string(" (") + ::strsignal(signal) + ")";
  if (std::ranges::find(kSignalsOfCrashes, signal) != std::end(kSignalsOfCrashes)) {
    return {Blame::helper, "crashed" + name};
  }
  switch (signal) {
    case SIGKILL:
      return {Blame::machine, "was killed" + name + ", as the system does when its memory is used up"};
    case SIGSYS:  // import/programs/system_calls.cpp
      return {Blame::helper, "was ended, since the file made it start another program" + name};
    case SIGBUS:
      return {Blame::machine, "could not read its memory" + name + ", as on a disk that fails"};
    default:
      return {Blame::machine, "was ended by a signal" + name};
  }
}

std::string milliseconds(std::chrono::milliseconds time) { return std::to_string(time.count()) + " ms"; }

}  // namespace

HelperFault fault_of(const HelperEnd& end) {
  switch (end.kind) {
    case HelperEndKind::exited:
      if (end.number == 0) return {};
      return {Blame::helper, "ended with exit status " + std::to_string(end.number)};
    case HelperEndKind::killed:
      return killed_by(end.number);
    case HelperEndKind::out_of_processor_time:
      return {Blame::machine, "did not finish in " + milliseconds(end.processor_time) + " of processor time"};
    case HelperEndKind::out_of_wall_time:
      return {Blame::machine, "did not finish in " + milliseconds(end.wall_time) + ", with a processor for " +
                                  milliseconds(end.processor_time)};
    case HelperEndKind::answered_without_end:
      return {Blame::machine, "gave more content than fits into the memory that it may use"};
  }
  SIMVIS_ASSERT(false);
  return {};
}

HelperFault fault_of(const HelperEnd& end, const ImportAnswer& answer) {
  if (answer.machine_fault) return {Blame::machine, *answer.machine_fault, true};
  HelperFault fault = fault_of(end);
  if (fault.blame == Blame::nobody && answer.refusal) fault = {Blame::file, *answer.refusal, true};
  return fault;
}

void throw_fault(Blame blame, const std::string& message) {
  SIMVIS_ASSERT(blame != Blame::nobody);
  if (blame == Blame::machine) throw MachineError(message);
  throw InputError(message);
}

}  // namespace simvis
