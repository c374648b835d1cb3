#include "scenegraph/import/inventor/guarded_child.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <fstream>
#include <new>
#include <optional>
#include <span>
#include <sstream>
#include <thread>

#include <simvis/error.h>
#include "scenegraph/language/source_text.h"

namespace simvis {
namespace {

constexpr std::size_t kMaxLogBytes = std::size_t{64} << 10;
constexpr int kFinished = 0, kThrew = 1;

[[noreturn]] void fail(const char* what) {
  throw MachineError(std::string("cannot start a process to read a file in: ") + what + ": " + std::strerror(errno));
}

// A file without a name, in memory: it holds what a process wrote, however that process ended.
class MemoryFile {
 public:
  explicit MemoryFile(const char* name) : file_(::memfd_create(name, MFD_CLOEXEC)) {
    if (file_ < 0) fail("memfd_create");
  }
  ~MemoryFile() { ::close(file_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  int descriptor() const { return file_; }

  std::vector<std::uint8_t> content() const {
    struct stat status {};
    if (::fstat(file_, &status) != 0) fail("fstat");
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(status.st_size));
    std::size_t at = 0;
    while (at < bytes.size()) {
      const ssize_t got = ::pread(file_, bytes.data() + at, bytes.size() - at, static_cast<off_t>(at));
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) fail("pread");
      at += static_cast<std::size_t>(got);
    }
    return bytes;
  }

 private:
  int file_;
};

bool write_all(int file, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

// AddressSanitizer maps terabytes for itself.
void limit_memory([[maybe_unused]] std::size_t more_bytes) {
#ifndef __SANITIZE_ADDRESS__
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  const rlim_t limit = pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)) + more_bytes;
  const rlimit memory{limit, limit};
  ::setrlimit(RLIMIT_AS, &memory);
#endif
}

// The parent's signal handlers have no business here, and nobody wants to hear or keep a core of what crashes.
void isolate(const ChildLimits& limits) {
  for (int signal = 1; signal < NSIG; ++signal) std::signal(signal, SIG_DFL);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  limit_memory(limits.memory_bytes);
  const int nowhere = ::open("/dev/null", O_RDWR);
  for (int stream = 0; stream < 3; ++stream) ::dup2(nowhere, stream);
}

[[noreturn]] void be_the_child(const ChildWork& work, const ChildLimits& limits, int result_file, int log_file) {
  isolate(limits);
  int status = kThrew;
  std::vector<std::uint8_t> result;
  const auto say = [&result](std::string_view text) { result.assign(text.begin(), text.end()); };
  try {
    ChildLog log(log_file);
    result = work(log);
    status = kFinished;
  } catch (const std::bad_alloc&) {
    say("it takes more than " + std::to_string(limits.memory_bytes >> 20) + " MiB of memory");
  } catch (const std::exception& e) {
    say(e.what());
  } catch (...) {
    say("an unknown exception");
  }
  if (!write_all(result_file, result)) ::raise(SIGKILL);
  ::_exit(status);
}

// The status of a child that ended in time.
std::optional<int> wait_for(pid_t child, std::chrono::milliseconds limit) {
  constexpr std::chrono::microseconds kShortest{200}, kLongest{5'000};
  const auto deadline = std::chrono::steady_clock::now() + limit;
  int status = 0;
  for (auto pause = kShortest;; pause = std::min(pause * 2, kLongest)) {
    const pid_t ended = ::waitpid(child, &status, WNOHANG);
    if (ended == child) return status;
    if (ended < 0 && errno != EINTR) fail("waitpid");
    if (std::chrono::steady_clock::now() >= deadline) break;
    std::this_thread::sleep_for(pause);
  }
  ::kill(child, SIGKILL);
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return std::nullopt;
}

bool is_ascii(char c) { return static_cast<unsigned char>(c) < 0x80; }

bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

bool is_utf8(const std::string& text) {
  try {
    SourceText(text, {});
    return true;
  } catch (const InputError&) {
    return false;
  }
}

std::vector<std::string> lines_of(const std::vector<std::uint8_t>& bytes) {
  std::istringstream text(std::string(bytes.begin(), bytes.end()));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

}  // namespace

void ChildLog::add(std::string_view line) {
  std::string text(line.substr(0, kMaxLogBytes));
  std::replace_if(text.begin(), text.end(), is_control, ' ');
  if (!is_utf8(text)) std::replace_if(text.begin(), text.end(), std::not_fn(is_ascii), '?');
  text.push_back('\n');
  if (bytes_ + text.size() > kMaxLogBytes) return;
  if (write_all(file_, bytes_of(text))) bytes_ += text.size();
}

ChildReport run_in_child(const ChildWork& work, const ChildLimits& limits) {
  const MemoryFile result("result"), log("log");
  const pid_t child = ::fork();
  if (child < 0) fail("fork");
  if (child == 0) be_the_child(work, limits, result.descriptor(), log.descriptor());
  const std::optional<int> status = wait_for(child, limits.time);
  ChildReport report;
  report.log = lines_of(log.content());
  if (!status) {
    report.end = ChildEnd::took_too_long;
  } else if (!WIFEXITED(*status)) {
    report.reason = WIFSIGNALED(*status) ? ::strsignal(WTERMSIG(*status)) : "stopped";
  } else if (WEXITSTATUS(*status) == kFinished) {
    report.end = ChildEnd::finished;
    report.result = result.content();
  } else if (WEXITSTATUS(*status) == kThrew) {
    report.end = ChildEnd::threw;
    const std::vector<std::uint8_t> text = result.content();
    report.reason.assign(text.begin(), text.end());
  } else {
    report.reason = "exit status " + std::to_string(WEXITSTATUS(*status));
  }
  return report;
}

}  // namespace simvis
