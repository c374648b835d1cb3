// The exceptions of SimVis: the user's input is wrong, or the machine failed. Programming errors assert instead.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>

#include <simvis/export.h>

namespace simvis {

/// Base of every exception that SimVis throws.
class SIMVIS_API Error : public std::runtime_error {
 public:
  /// Writes each NUL byte as an escape sequence, since a NUL ends `what()`.
  explicit Error(std::string message) : std::runtime_error(without_nul(std::move(message))) {}

 private:
  static std::string without_nul(std::string message) {
    constexpr const char* kNul = "\\x00";
    std::size_t at = 0;
    while ((at = message.find('\0', at)) != std::string::npos) message.replace(at, 1, kNul);
    return message;
  }
};

/// Wrong user input: a scene file, a part, a parameter, a command line. `what()` says where, what was seen and what
/// is allowed; with a known place it reads `FILE:LINE:COLUMN: error: ...`. simvis-run exits with 2.
class SIMVIS_API InputError : public Error {
 public:
  using Error::Error;
};

/// A failure of the machine: no device, device lost, out of memory, disk full or failing, too many open files, a helper
/// program at its limit of time. `what()` carries the Vulkan result or the operating system's reason. simvis-run exits
/// with 1.
class SIMVIS_API MachineError : public Error {
 public:
  using Error::Error;
};

/// A consumer of frames has failed: the shared memory, the recording, DDS, or the program's own. The frame itself is
/// made: its measurements, time and counts are those of a run without this consumer. `what()` names the consumer and
/// its reason; if several have failed at one frame, all of them: "recording: REASON; DDS: REASON".
class SIMVIS_API OutletError : public MachineError {
 public:
  using MachineError::MachineError;
};

}  // namespace simvis
