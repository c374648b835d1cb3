#include "import/sandbox/sandbox_process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <ctime>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>

#include <simvis/error.h>

namespace simvis {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kNotStarted = 127;  // exit status of a program whose shared libraries are missing

[[noreturn]] void fail_to_start(const SandboxCall& call, const std::string& why) {
  throw MachineError("cannot start " + call.program.string() + ", the helper program that " +
                     std::string(call.purpose) + ": " + why);
}

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  int number() const { return number_; }
  void close() {
    if (number_ >= 0) ::close(number_);
    number_ = -1;
  }

 private:
  int number_;
};

// This number is above all descriptors of the program, so that setting those up cannot overwrite it.
int above_those_of_the_program(int descriptor) { return ::fcntl(descriptor, F_DUPFD_CLOEXEC, kAnswerDescriptor + 1); }

// Returns a file in memory that is read from its start, or -1 for no bytes.
int file_with_input(const SandboxCall& call) {
  std::span<const std::uint8_t> bytes = call.input;
  if (bytes.empty()) return -1;
  const Descriptor file(::memfd_create("input", MFD_CLOEXEC));
  if (file.number() < 0) fail_to_start(call, std::strerror(errno));
  while (!bytes.empty()) {
    const ssize_t written = ::write(file.number(), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail_to_start(call, std::strerror(errno));
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  const int number = above_those_of_the_program(file.number());
  if (number < 0 || ::lseek(number, 0, SEEK_SET) != 0) fail_to_start(call, std::strerror(errno));
  return number;
}

// The start conditions of the program. It inherits no signal handlers, signal masks or open files of this process.
class StartConditions {
 public:
  StartConditions(const Descriptor& input, int answer) {
    ::posix_spawn_file_actions_init(&files_);
    for (int stream = 0; stream < kAnswerDescriptor; ++stream) {
      ::posix_spawn_file_actions_addopen(&files_, stream, "/dev/null", O_RDWR, 0);
    }
    if (input.number() >= 0) ::posix_spawn_file_actions_adddup2(&files_, input.number(), STDIN_FILENO);
    ::posix_spawn_file_actions_adddup2(&files_, answer, kAnswerDescriptor);
    ::posix_spawn_file_actions_addclosefrom_np(&files_, kAnswerDescriptor + 1);
    ::posix_spawnattr_init(&attributes_);
    sigset_t none, all;
    ::sigemptyset(&none);
    ::sigfillset(&all);
    ::posix_spawnattr_setsigmask(&attributes_, &none);
    ::posix_spawnattr_setsigdefault(&attributes_, &all);
    // Ctrl-C goes to the process group of the terminal. It is for SimVis, which ends in order.
    ::posix_spawnattr_setpgroup(&attributes_, 0);
    ::posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  }
  ~StartConditions() {
    ::posix_spawn_file_actions_destroy(&files_);
    ::posix_spawnattr_destroy(&attributes_);
  }
  StartConditions(const StartConditions&) = delete;
  StartConditions& operator=(const StartConditions&) = delete;

  const posix_spawn_file_actions_t* files() const { return &files_; }
  const posix_spawnattr_t* attributes() const { return &attributes_; }

 private:
  posix_spawn_file_actions_t files_;
  posix_spawnattr_t attributes_;
};

std::vector<char*> environment_of(const SandboxCall& call) {
  const auto replaced = [&](std::string_view variable) {
    const std::string_view start = variable.substr(0, std::min(variable.find('=') + 1, variable.size()));
    return std::ranges::any_of(call.environment, [&](const std::string& own) { return own.starts_with(start); });
  };
  std::vector<char*> variables;
  for (char** variable = ::environ; call.inherits_environment && *variable != nullptr; ++variable) {
    if (!replaced(*variable)) variables.push_back(*variable);
  }
  for (const std::string& own : call.environment) variables.push_back(const_cast<char*>(own.c_str()));
  variables.push_back(nullptr);
  return variables;
}

// A process and the time that it uses. After the program has ended, both times stay as they were.
class Process {
 public:
  Process(const SandboxCall& call, const Descriptor& input, int answer) : call_(call), started_(Clock::now()) {
    std::vector<char*> arguments{const_cast<char*>(call.program.c_str())};
    for (const std::string& argument : call.arguments) arguments.push_back(const_cast<char*>(argument.c_str()));
    arguments.push_back(nullptr);
    const StartConditions start(input, answer);
    const std::vector<char*> environment = environment_of(call);
    const int error = ::posix_spawn(&id_, call.program.c_str(), start.files(), start.attributes(), arguments.data(),
                                    environment.data());
    if (error != 0) fail_to_start(call, std::strerror(error));
    limit_processor_time();
  }
  ~Process() { kill(); }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  // Returns which limit of time the process has reached. If none, `left` is how long it certainly takes to the next
  // one; a program with several threads may reach it earlier, and is asked again before.
  std::optional<HelperEnd> reached_limit(std::chrono::milliseconds& left) {
    constexpr std::chrono::milliseconds kShortest{10}, kLongest{1'000};
    const std::chrono::milliseconds processor = call_.time - processor_time(), wall = call_.wall_time - wall_time();
    left = std::clamp(std::min(processor, wall), kShortest, kLongest);
    if (processor.count() <= 0) return ended(HelperEndKind::out_of_processor_time);
    if (wall.count() <= 0) return ended(HelperEndKind::out_of_wall_time);
    return std::nullopt;
  }

  // Waits until the process ends or reaches a limit. If the host ignores SIGCHLD there is no status; the function then
  // returns exit status 0, and the answer shows whether the program succeeded.
  HelperEnd wait() {
    constexpr std::chrono::microseconds kShortest{50}, kLongest{5'000};
    for (auto pause = kShortest;; pause = std::min(pause * 2, kLongest)) {
      if (is_gone()) {
        const int status = kill();
        if (WIFSIGNALED(status)) return ended(HelperEndKind::killed, WTERMSIG(status));
        return ended(HelperEndKind::exited, WEXITSTATUS(status));
      }
      std::chrono::milliseconds left;
      if (const std::optional<HelperEnd> end = reached_limit(left)) return *end;
      std::this_thread::sleep_for(pause);
    }
  }

  HelperEnd ended(HelperEndKind kind, int number = 0) {
    return {.kind = kind, .number = number, .processor_time = processor_time(), .wall_time = wall_time()};
  }

  // Whether the process has ended; its number stays taken, so that its group can be killed.
  bool is_gone() {
    siginfo_t end{};
    const bool is_known = ::waitid(P_PID, static_cast<id_t>(id_), &end, WEXITED | WNOHANG | WNOWAIT) == 0;
    has_number_ = is_known || errno != ECHILD;
    return !has_number_ || (is_known && end.si_pid == id_);
  }

  // Kills the process, if it has not ended, and all of its group. Returns its status; 0 if it has none.
  int kill() {
    int status = 0;
    if (id_ == 0) return status;
    if (has_number_) ::kill(-id_, SIGKILL);
    while (::waitpid(id_, &status, 0) < 0 && errno == EINTR) {
    }
    id_ = 0;
    return status;
  }

 private:
  // For a program whose SimVis is stopped or gone; reached_limit() comes first.
  void limit_processor_time() const {
    const auto seconds = static_cast<rlim_t>(std::chrono::ceil<std::chrono::seconds>(call_.time).count()) + 2;
    const rlimit limit{seconds, seconds};
    ::prlimit(id_, RLIMIT_CPU, &limit, nullptr);
  }

  // Of all threads of the process, but not of processes that it starts.
  std::chrono::milliseconds processor_time() {
    clockid_t clock = 0;
    timespec used{};
    if (id_ == 0 || ::clock_getcpuclockid(id_, &clock) != 0 || ::clock_gettime(clock, &used) != 0) return used_;
    return used_ = std::chrono::milliseconds(used.tv_sec * 1'000 + used.tv_nsec / 1'000'000);
  }
  std::chrono::milliseconds wall_time() const {
    return std::chrono::floor<std::chrono::milliseconds>(Clock::now() - started_);
  }

  const SandboxCall& call_;
  Clock::time_point started_;
  std::chrono::milliseconds used_{0};
  pid_t id_ = 0;
  bool has_number_ = true;  // until a host that ignores SIGCHLD has given it away
};

// Reads until the other end closes or the process has ended, `most` bytes are there, or the process reaches a limit of
// time. Returns its end in the last two cases.
std::optional<HelperEnd> read_answer(int pipe, std::size_t most, Process& process, GrowingBytes& bytes) {
  std::optional<HelperEnd> end;
  while (true) {
    std::chrono::milliseconds left;
    if ((end = process.reached_limit(left))) break;
    pollfd waiting{pipe, POLLIN, 0};
    const int ready = ::poll(&waiting, 1, static_cast<int>(left.count()));
    if (ready == 0 && process.is_gone()) break;  // a process that it has started keeps the other end open
    if (ready <= 0) continue;
    const std::span<std::uint8_t> room = bytes.room(most);
    if (room.empty()) {
      end = process.ended(HelperEndKind::answered_without_end);
      break;
    }
    const ssize_t got = ::read(pipe, room.data(), room.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    bytes.add(static_cast<std::size_t>(got));
  }
  return end;
}

}  // namespace

SandboxReport run_in_sandbox(const SandboxCall& call) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) fail_to_start(call, std::strerror(errno));
  const Descriptor reading(ends[0]);
  Descriptor first_writing(ends[1]);
  Descriptor writing(above_those_of_the_program(ends[1]));
  if (writing.number() < 0) fail_to_start(call, std::strerror(errno));
  first_writing.close();
  constexpr int kPipeBytes = 1 << 20;
  ::fcntl(reading.number(), F_SETPIPE_SZ, kPipeBytes);  // for speed only; a failure has no other effect
  const Descriptor input(file_with_input(call));
  Process process(call, input, writing.number());
  writing.close();
  SandboxReport report;
  const std::optional<HelperEnd> killed = read_answer(reading.number(), call.answer_bytes, process, report.answer);
  report.end = killed ? *killed : process.wait();
  if (report.end.kind == HelperEndKind::exited && report.end.number == kNotStarted && report.answer.bytes().empty()) {
    fail_to_start(call, "exit status 127; probably a shared library is missing, or there is no memory for it");
  }
  return report;
}

}  // namespace simvis
