// The four measurements of bench/serving, and the functions with which they run other processes.
#pragma once

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>
#include <vector>

namespace simvis::bench {

void measure_latency(int writes);
void measure_updates(std::size_t checks);
void measure_follower(int blocks);
void measure_opening(int parts);

/// A name that no other process serves.
inline std::string own_name(const std::string& what) { return "bench-" + what + "-" + std::to_string(::getpid()); }

/// Runs `body` in another process.
template <typename Body>
pid_t in_child(const Body& body) {
  const pid_t child = ::fork();
  if (child != 0) return child;
  int status = 1;
  try {
    body();
    status = 0;
  } catch (...) {
  }
  ::_exit(status);
}

/// Starts a program whose output is discarded.
inline pid_t start_program(const std::vector<std::string>& arguments) {
  std::vector<char*> pointers;
  for (const std::string& argument : arguments) pointers.push_back(const_cast<char*>(argument.c_str()));
  pointers.push_back(nullptr);
  const pid_t child = ::vfork();
  if (child != 0) return child;
  ::execv(pointers[0], pointers.data());
  ::_exit(127);
}

inline int wait_for(pid_t child) {
  int status = 0;
  ::waitpid(child, &status, 0);
  return status;
}

inline void kill_hard(pid_t child) {
  ::kill(child, SIGKILL);
  wait_for(child);
}

}  // namespace simvis::bench
