// Runs a program and captures its output.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/temporary_folder.h"

extern char** environ;

namespace simvis {

struct ProcessResult {
  int exit_code = -1;  ///< -1: it was ended by a signal
  int signal = 0;
  bool timed_out = false;  ///< it was then killed
  std::string out, err;
};

/// A running program. Its output goes to files, so that it never waits for a reader. `environment` holds "NAME=VALUE",
/// written over this program's own.
class Process {
 public:
  Process(const std::vector<std::string>& arguments, const std::vector<std::string>& environment = {}) {
    std::vector<std::string> all = environment;
    for (char** entry = environ; *entry != nullptr; ++entry) {
      const std::string text = *entry;
      const std::string name = text.substr(0, text.find('=') + 1);
      const bool replaced = std::any_of(environment.begin(), environment.end(),
                                        [&](const std::string& own) { return own.starts_with(name); });
      if (!replaced) all.push_back(text);
    }
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, (output_ / "out").c_str(), O_WRONLY | O_CREAT, 0600);
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, (output_ / "err").c_str(), O_WRONLY | O_CREAT, 0600);
    const int error =
        posix_spawnp(&pid_, arguments[0].c_str(), &files, nullptr, pointers(arguments).data(), pointers(all).data());
    posix_spawn_file_actions_destroy(&files);
    if (error != 0) throw std::runtime_error("cannot start " + arguments[0]);
  }
  ~Process() {
    if (pid_ > 0) wait(std::chrono::seconds(0));
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void send(int signal) const { ::kill(pid_, signal); }
  /// What it has written to its standard error so far.
  std::string err_so_far() const { return read_text(output_ / "err"); }

  /// Once. Kills the program when it takes longer.
  ProcessResult wait(std::chrono::seconds patience = std::chrono::seconds(120)) {
    ProcessResult result;
    const auto end = std::chrono::steady_clock::now() + patience;
    int status = 0;
    while (::waitpid(pid_, &status, WNOHANG) == 0) {
      if (!result.timed_out && std::chrono::steady_clock::now() > end) {
        result.timed_out = true;
        send(SIGKILL);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    pid_ = 0;
    if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
    if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
    result.out = read_text(output_ / "out");
    result.err = read_text(output_ / "err");
    return result;
  }

 private:
  static std::vector<char*> pointers(const std::vector<std::string>& strings) {
    std::vector<char*> result;
    for (const std::string& string : strings) result.push_back(const_cast<char*>(string.c_str()));
    result.push_back(nullptr);
    return result;
  }

  TemporaryFolder output_;
  pid_t pid_ = 0;
};

}  // namespace simvis
