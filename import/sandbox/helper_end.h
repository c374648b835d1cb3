// The one place that says how a helper program ended, and whose fault that is.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "import/sandbox/import_answer.h"

namespace simvis {

enum class HelperEndKind : std::uint8_t {
  exited,                 ///< `number` is the exit status
  killed,                 ///< by another than SimVis; `number` is the signal
  out_of_processor_time,  ///< killed at the limit of its processor time
  out_of_wall_time,       ///< killed at the limit of the time by the clock
  answered_without_end    ///< killed after the longest answer
};

struct HelperEnd {
  HelperEndKind kind = HelperEndKind::exited;
  int number = 0;
  std::chrono::milliseconds processor_time{0};  ///< that it has used
  std::chrono::milliseconds wall_time{0};       ///< since its start
};

/// Whose fault it is that there is no result. A fault of the machine must never become a warning: another run would
/// give other data. Those of the file and of its reader are the same in each run.
enum class Blame : std::uint8_t {
  nobody,   ///< there is a result
  file,     ///< it is broken
  machine,  ///< no time, no memory, a disk that fails, a signal from outside
  helper    ///< the program or its library crashes on the file; memory and disk have not failed before
};

struct HelperFault {
  Blame blame = Blame::nobody;
  std::string reason;        ///< what to say after the name of the program, such as "crashed (Segmentation fault)"
  bool is_reported = false;  ///< `reason` is by the program itself, a whole sentence about the file
};

/// From how the program ended alone. An exit status other than 0 is the helper's.
HelperFault fault_of(const HelperEnd& end);

/// The same for a program that answers by AnswerWriter: what it reports itself comes first, then a bad end, then its
/// refusal of the file. Without a fault, the answer may still lack a scene.
HelperFault fault_of(const HelperEnd& end, const ImportAnswer& answer);

/// Throws MachineError for a fault of the machine. Throws InputError for one of the file, and for one of the helper:
/// this SimVis cannot read the file, as if it were broken. `blame` is not nobody.
[[noreturn]] void throw_fault(Blame blame, const std::string& message);

}  // namespace simvis
