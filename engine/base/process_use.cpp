#include "engine/base/process_use.h"

#include <pthread.h>
#include <unistd.h>

#include <atomic>
#include <string>
#include <system_error>

#include <simvis/error.h>

namespace simvis {
namespace {

std::atomic<unsigned> forks = 0;      // between this process and the first that used the library
std::atomic<unsigned> users = 0;      // those of this process and, after a fork, those that it inherited
std::atomic<pid_t> forked_from = 0;   // the process whose users this one has inherited; 0: it has none
std::atomic<pid_t> user_process = 0;  // the process of the last user

// Only async-signal-safe functions are allowed here.
void count_fork() {
  ++forks;
  if (users > 0 && forked_from == 0) forked_from = user_process.load();
}

void watch_forks() {
  static const int error = ::pthread_atfork(nullptr, nullptr, count_fork);
  if (error != 0) throw MachineError("pthread_atfork: " + std::generic_category().message(error));
}

[[noreturn]] void refuse(pid_t parent) {
  throw InputError("this process was forked from process " + std::to_string(parent) +
                   ", which uses SimVis, and has neither its threads nor its Vulkan driver; expected a new "
                   "process, or one that was forked before the first simulation was loaded");
}

}  // namespace

ProcessUse::ProcessUse() : process_(::getpid()) {
  watch_forks();
  if (forked_from != 0) refuse(forked_from);
  forks_ = forks;
  user_process = process_;
  ++users;
}

ProcessUse::~ProcessUse() { --users; }

bool ProcessUse::forked() const { return forks_ != forks; }

void ProcessUse::require_not_forked() const {
  if (forked()) refuse(process_);
}

}  // namespace simvis
