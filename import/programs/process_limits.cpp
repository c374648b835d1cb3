#include "import/programs/process_limits.h"

#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <fstream>

#include <simvis/error.h>
#include "import/programs/file_access.h"
#include "import/sandbox/sandbox_process.h"

namespace simvis {
namespace {

void set_limit(__rlimit_resource resource, rlim_t value) {
  rlimit limit{};
  bool is_set = ::getrlimit(resource, &limit) == 0;
  limit.rlim_cur = limit.rlim_max = std::min(value, limit.rlim_max);  // keeps a stricter limit
  is_set = is_set && ::setrlimit(resource, &limit) == 0;
  if (!is_set) throw MachineError("cannot limit what the helper program that reads part files may use");
}

void limit_memory([[maybe_unused]] std::size_t more_bytes) {
#ifndef __SANITIZE_ADDRESS__
  std::size_t pages = 0;
  if (!(std::ifstream("/proc/self/statm") >> pages)) throw MachineError("cannot read how much memory a process uses");
  set_limit(RLIMIT_AS, pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)) + more_bytes);
#endif
}

void end_with_simvis() {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  pollfd answer{kAnswerDescriptor, 0, 0};  // SimVis may have ended before
  if (::poll(&answer, 1, 0) > 0 && (answer.revents & POLLERR) != 0) ::_exit(1);
}

}  // namespace

void limit_process(const ProcessLimits& limits) {
  end_with_simvis();
  set_limit(RLIMIT_CORE, 0);
  set_limit(RLIMIT_NOFILE, kMaxOpenFiles);
  set_limit(RLIMIT_FSIZE, limits.memory_bytes);  // of files in memory: it can write no others
  limit_memory(limits.memory_bytes);
  restrict_files(limits.folders);
  if (!restrict_system_calls(limits.program) && limits.program == HelperProgram::xacro) {
    throw MachineError(
        "this kernel cannot limit the system calls of a process (seccomp), and without that the file could run any "
        "code; expand it on another computer: xacro FILE > robot.urdf");
  }
}

}  // namespace simvis
