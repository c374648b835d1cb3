// Ends a run in order when the user or the system asks for it.
#pragma once

#include <stdexcept>

namespace simvis {

/// The exit status of a run that a signal stopped.
inline constexpr int kExitStopped = 130;

/// Thrown by stop_if_asked_to().
struct Stopped : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// From now on SIGINT, SIGTERM and SIGHUP end the program at once with kExitStopped. A file beyond the size limit and a
/// closed pipe become errors of the write.
void handle_signals();

/// From now on the first signal only sets received_signal(); the second one ends the program at once.
void defer_signals();

/// Ends the run as SIGTERM does, whether or not a signal came before or SIGTERM is ignored.
void ask_to_stop();

/// The name of the signal, "Interrupt"; null: none came.
const char* received_signal();

/// Throws Stopped if a signal came.
void stop_if_asked_to();

}  // namespace simvis
