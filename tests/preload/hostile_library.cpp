// A library for LD_PRELOAD that does in a helper program what an attacker would do whose file has made a library run
// his code: at the first read of the part it tries what a program that reads must not do. For each attempt that the
// system allows it writes a word to SIMVIS_HOSTILE_LOG, and "tried" at the end. Python loads it and calls
// try_system_calls().
#include <dlfcn.h>
#include <fcntl.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "import/programs/system_calls.h"

namespace {

constexpr long kFchmodat2 = 452;

using simvis::HelperProgram;

struct Helper {
  const char* name;
  HelperProgram program;
};
constexpr Helper kHelpers[] = {{"simvis-import-mesh", HelperProgram::mesh},
                               {"simvis-import-inventor", HelperProgram::inventor},
                               {"simvis-decode", HelperProgram::decode}};

const Helper* this_helper() {
  for (const Helper& helper : kHelpers) {
    if (std::strcmp(program_invocation_short_name, helper.name) == 0) return &helper;
  }
  return nullptr;
}

// Opened before the program begins.
int report =
    this_helper() != nullptr ? ::open(std::getenv("SIMVIS_HOSTILE_LOG"), O_CREAT | O_WRONLY | O_APPEND, 0600) : -1;

void say(const char* word) {
  if (::write(report, word, std::strlen(word)) < 0) std::abort();
}

// `result` is of a call that the filter must refuse; the kernel's own reason to refuse it would be another.
void must_fail(const char* word, long result) {
  if (result != -1 || (errno != EPERM && errno != ENOSYS)) say(word);
}

// Every number that the kernel may know, with arguments that are wrong for all of them.
void try_every_call(HelperProgram program) {
  constexpr long kCalls = 1024;
  std::vector<int> left_out = simvis::allowed_system_calls(program);
  if (program == HelperProgram::xacro) {  // these end it
    left_out.insert(left_out.end(), {SYS_execve, SYS_execveat});
#if defined(__x86_64__)
    left_out.insert(left_out.end(), {SYS_fork, SYS_vfork});
#endif
  }
#if defined(__x86_64__)
  // uretprobe() and uprobe(): Linux passes them by the filter, and ends each process that calls them itself.
  left_out.insert(left_out.end(), {335, 336});
#endif
  for (long call = 0; call < kCalls; ++call) {
    if (std::find(left_out.begin(), left_out.end(), call) != left_out.end()) continue;
    must_fail(("call-" + std::to_string(call) + " ").c_str(), ::syscall(call, -1, -1, -1, -1, -1, -1));
  }
#if defined(__x86_64__)
  constexpr long kX32 = 0x40000000;
  for (long call = 0; call < kCalls; ++call) {
    must_fail(("x32-call-" + std::to_string(call) + " ").c_str(), ::syscall(kX32 | call, -1, -1, -1, -1, -1, -1));
  }
#endif
}

// Calls that are allowed with other arguments.
void try_arguments(HelperProgram program) {
  const pid_t parent = ::getppid();
  const int on = 1;
  must_fail("setown ", ::fcntl(report, F_SETOWN, parent));
  must_fail("setsig ", ::fcntl(report, F_SETSIG, SIGKILL));
  must_fail("setown-ex ", ::fcntl(report, F_SETOWN_EX, &parent));
  must_fail("setfl ", ::fcntl(report, F_SETFL, O_ASYNC));
  must_fail("setlease ", ::fcntl(report, F_SETLEASE, F_RDLCK));
  must_fail("notify ", ::fcntl(report, F_NOTIFY, DN_MODIFY));
  must_fail("lock ", ::fcntl(report, F_SETLK, nullptr));
  must_fail("pipe-size ", ::fcntl(report, F_SETPIPE_SZ, 4096));
  must_fail("ioctl-async ", ::ioctl(report, FIOASYNC, &on));
  must_fail("ioctl-owner ", ::ioctl(report, FIOSETOWN, &parent));
  must_fail("ioctl-type ", ::ioctl(report, TIOCSTI, "x"));
  must_fail("dumpable ", ::prctl(PR_SET_DUMPABLE, 1, 0, 0, 0));
  must_fail("tracer ", ::prctl(PR_SET_PTRACER, PR_SET_PTRACER_ANY, 0, 0, 0));
  must_fail("parent-death ", ::prctl(PR_SET_PDEATHSIG, 0, 0, 0, 0));
  must_fail("memory-map ", ::prctl(PR_SET_MM, PR_SET_MM_ARG_START, 0, 0, 0));
  must_fail("kill-all ", ::kill(-1, 0));
  must_fail("kill-group ", ::kill(0, 0));
  must_fail("tgkill ", ::syscall(SYS_tgkill, parent, parent, 0));
  rlimit limit{};
  must_fail("own-limit ", ::getrlimit(RLIMIT_CORE, &limit) == 0 ? ::prlimit(0, RLIMIT_CORE, &limit, nullptr) : 0);
  must_fail("limits-of-parent ", ::prlimit(parent, RLIMIT_CORE, nullptr, &limit));
  constexpr int kReads = O_RDONLY | O_CLOEXEC;
  for (const int flags : {O_WRONLY, O_RDWR, kReads | O_CREAT, kReads | O_TRUNC, kReads | O_ASYNC, O_TMPFILE | O_RDWR}) {
    must_fail(("open-" + std::to_string(flags) + " ").c_str(), ::open("/tmp", flags, 0600));
  }
  if (program == HelperProgram::xacro) return;  // these end it
  must_fail("child ", ::syscall(SYS_clone, SIGCHLD, nullptr, nullptr, nullptr, nullptr));
  must_fail("namespace ", ::syscall(SYS_clone, CLONE_VM | CLONE_SIGHAND | CLONE_THREAD | CLONE_NEWUSER, nullptr,
                                    nullptr, nullptr, nullptr));
}

void try_all(HelperProgram program) {
  if (::socket(AF_INET, SOCK_STREAM, 0) >= 0) say("socket ");
  if (::socket(AF_UNIX, SOCK_STREAM, 0) >= 0) say("unix-socket ");
  const char* const file = std::getenv("SIMVIS_HOSTILE_FILE");
  if (::open(file, O_WRONLY | O_CREAT, 0600) >= 0) say("create ");
  if (::open(std::getenv("SIMVIS_HOSTILE_LOG"), O_RDWR) >= 0) say("write ");
  if (::open(std::getenv("SIMVIS_HOSTILE_SECRET"), O_RDONLY) >= 0) say("read ");
  if (::open("/etc/hostname", O_RDONLY) >= 0) say("read-system ");
  if (::open("/", O_RDONLY | O_DIRECTORY) >= 0) say("list ");
  if (::mkdir(file, 0700) == 0) say("mkdir ");
  if (::unlink(std::getenv("SIMVIS_HOSTILE_LOG")) == 0) say("unlink ");
  if (::symlink("/", file) == 0) say("symlink ");
  if (::syscall(SYS_renameat, AT_FDCWD, std::getenv("SIMVIS_HOSTILE_LOG"), AT_FDCWD, file) == 0) say("renameat ");
  if (::syscall(kFchmodat2, AT_FDCWD, std::getenv("SIMVIS_HOSTILE_LOG"), 0600, 0) == 0) say("chmod ");
  const rlimit no_time{0, RLIM_INFINITY};
  if (::prlimit(::getppid(), RLIMIT_CORE, &no_time, nullptr) == 0) say("prlimit ");
  if (::kill(::getppid(), 0) == 0) say("kill ");
  try_every_call(program);
  try_arguments(program);
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  if (child > 0) say("fork ");
  char* const arguments[] = {const_cast<char*>("true"), nullptr};
  say("tried");
  ::execv("/bin/true", arguments);
}

}  // namespace

extern "C" __attribute__((visibility("default"))) void try_system_calls(int program, int descriptor) {
  report = descriptor;
  try_every_call(static_cast<HelperProgram>(program));
  try_arguments(static_cast<HelperProgram>(program));
  say("tried");
}

extern "C" ssize_t pread(int descriptor, void* bytes, size_t count, off_t from) {
  static bool has_tried = false;
  if (const Helper* const helper = this_helper(); helper != nullptr && !has_tried) {
    has_tried = true;
    try_all(helper->program);
  }
  return reinterpret_cast<decltype(::pread)*>(::dlsym(RTLD_NEXT, "pread"))(descriptor, bytes, count, from);
}
