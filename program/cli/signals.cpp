#include "program/cli/signals.h"

#include <signal.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <string>

namespace simvis {

namespace {

volatile std::sig_atomic_t received = 0;
volatile std::sig_atomic_t deferred = 0;

void on_signal(int number) {
  if (deferred == 0 || received != 0) ::_exit(kExitStopped);
  received = number;
}

}  // namespace

void handle_signals() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  action.sa_flags = SA_RESTART;
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {};
    ::sigaction(number, nullptr, &before);
    if (before.sa_handler != SIG_IGN) ::sigaction(number, &action, nullptr);
  }
  ::signal(SIGXFSZ, SIG_IGN);
  ::signal(SIGPIPE, SIG_IGN);
}

void defer_signals() { deferred = 1; }

void ask_to_stop() {
  if (received == 0) received = SIGTERM;
}

const char* received_signal() { return received == 0 ? nullptr : ::strsignal(received); }

void stop_if_asked_to() {
  if (const char* const name = received_signal()) throw Stopped(std::string("stopped by a signal (") + name + ")");
}

}  // namespace simvis
