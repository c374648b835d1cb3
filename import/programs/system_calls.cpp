#include "import/programs/system_calls.h"

#include <asm/ioctls.h>
#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <initializer_list>

namespace simvis {
namespace {

#if defined(__x86_64__)
[[maybe_unused]] constexpr std::uint32_t kArchitecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
[[maybe_unused]] constexpr std::uint32_t kArchitecture = AUDIT_ARCH_AARCH64;
#else
[[maybe_unused]] constexpr std::uint32_t kArchitecture = 0;  // no filter
#endif

// Of every program. The first are asked first, because a large part makes them a hundred thousand times.
constexpr int kComputing[] = {
    __NR_pread64, __NR_read, __NR_write, __NR_brk, __NR_mmap, __NR_munmap,
    // files
    __NR_close, __NR_lseek, __NR_readv, __NR_writev, __NR_fstat, __NR_newfstatat, __NR_statx, __NR_readlinkat,
    __NR_faccessat, __NR_getcwd,
#if defined(__x86_64__)
    __NR_stat, __NR_lstat, __NR_readlink, __NR_access, __NR_time,
#endif
    // memory and threads
    __NR_mremap, __NR_mprotect, __NR_madvise, __NR_futex, __NR_set_robust_list, __NR_rseq, __NR_sched_yield,
    __NR_sched_getaffinity, __NR_getcpu, __NR_exit, __NR_exit_group,
    // signals that the process gives itself
    __NR_rt_sigaction, __NR_rt_sigprocmask, __NR_rt_sigreturn, __NR_sigaltstack, __NR_restart_syscall,
    // time, and what the process is
    __NR_clock_gettime, __NR_clock_getres, __NR_gettimeofday, __NR_nanosleep, __NR_clock_nanosleep, __NR_getrandom,
    __NR_getpid, __NR_getppid, __NR_gettid, __NR_getuid, __NR_geteuid, __NR_getgid, __NR_getegid, __NR_getrusage,
    __NR_getrlimit, __NR_sysinfo, __NR_uname};

// For names that are searched in folders.
constexpr int kListing[] = {__NR_getdents64};

// Coin gets a part as a stream over a file in memory.
constexpr int kFilesInMemory[] = {__NR_memfd_create, __NR_dup};

constexpr int kOfPython[] = {__NR_dup, __NR_fstatfs, __NR_statfs, __NR_fadvise64};

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

// Linux 5.1: later calls have numbers from here on, which are the same on all processors.
constexpr int kFirstRecent = 424;

constexpr std::uint32_t kAllow = SECCOMP_RET_ALLOW, kRefuse = SECCOMP_RET_ERRNO | EPERM;
constexpr std::uint32_t kAbsent = SECCOMP_RET_ERRNO | ENOSYS;

constexpr int kStarting[] = {
#if defined(__x86_64__)
    __NR_fork, __NR_vfork,
#endif
    __NR_execve, __NR_execveat};

// The answer to a program that starts another. Code in an expression of xacro could go on as if that one had failed.
constexpr std::uint32_t answer_to_start(HelperProgram program) {
  return program == HelperProgram::xacro ? SECCOMP_RET_KILL_PROCESS : kRefuse;
}

using Filter = std::vector<sock_filter>;

void load(Filter& filter, std::size_t offset) {
  filter.push_back(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offset)));
}

void answer(Filter& filter, std::uint32_t result) { filter.push_back(BPF_STMT(BPF_RET | BPF_K, result)); }

// Where the test of what is loaded holds.
void answer_if(Filter& filter, std::uint16_t test, std::uint32_t value, std::uint32_t result) {
  filter.push_back(BPF_JUMP(static_cast<std::uint16_t>(BPF_JMP | test | BPF_K), value, 0, 1));
  answer(filter, result);
}

// The low half of an argument; the processors are little-endian.
constexpr std::size_t argument(std::size_t number) {
  return offsetof(seccomp_data, args) + number * sizeof(std::uint64_t);
}

Filter one_of(std::size_t number, std::initializer_list<std::uint32_t> values) {
  Filter filter;
  load(filter, argument(number));
  for (const std::uint32_t value : values) answer_if(filter, BPF_JEQ, value, kAllow);
  answer(filter, kRefuse);
  return filter;
}

Filter without_bits(std::size_t number, std::uint32_t bits) {
  Filter filter;
  load(filter, argument(number));
  answer_if(filter, BPF_JSET, bits, kRefuse);
  answer(filter, kAllow);
  return filter;
}

// clone() as pthread_create() calls it.
Filter threads_alone(std::uint32_t otherwise) {
  constexpr std::uint32_t kOfThreads = CLONE_VM | CLONE_FS | CLONE_FILES | CLONE_SIGHAND | CLONE_THREAD |
                                       CLONE_SYSVSEM | CLONE_SETTLS | CLONE_PARENT_SETTID | CLONE_CHILD_CLEARTID;
  Filter filter;
  load(filter, argument(0));
  answer_if(filter, BPF_JSET, ~kOfThreads, otherwise);
  answer_if(filter, BPF_JSET, CLONE_THREAD, kAllow);
  answer(filter, otherwise);
  return filter;
}

// prlimit64() that asks for limits of the process itself and sets none.
Filter own_limits() {
  Filter filter;
  for (const std::size_t offset : {argument(0), argument(2), argument(2) + sizeof(std::uint32_t)}) {
    load(filter, offset);
    filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, 0, 1, 0));
    answer(filter, kRefuse);
  }
  answer(filter, kAllow);
  return filter;
}

#endif

constexpr int kByArguments[] = {
#if defined(__x86_64__)
    __NR_open,
#endif
    __NR_openat, __NR_clone, __NR_kill, __NR_tgkill, __NR_prlimit64, __NR_fcntl, __NR_ioctl, __NR_prctl};

void append(std::vector<int>& calls, std::initializer_list<std::vector<int>> more) {
  for (const std::vector<int>& each : more) calls.insert(calls.end(), each.begin(), each.end());
}

template <std::size_t count>
std::vector<int> listed(const int (&calls)[count]) {
  return {calls, calls + count};
}

// The calls that a program may make with any arguments.
std::vector<int> calls_of(HelperProgram program) {
  std::vector<int> calls = listed(kComputing);
  switch (program) {
    case HelperProgram::decode:
      break;
    case HelperProgram::mesh:
      append(calls, {listed(kListing)});
      break;
    case HelperProgram::inventor:
      append(calls, {listed(kListing), listed(kFilesInMemory)});
      break;
    case HelperProgram::usd:
    case HelperProgram::xacro:
      append(calls, {listed(kListing), listed(kOfPython)});
      break;
  }
  return calls;
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

// What stands in the filter for a call of kByArguments.
Filter test_of_arguments(int call, HelperProgram program) {
  constexpr std::uint32_t kWrites = O_WRONLY | O_RDWR | O_CREAT | O_TRUNC | O_ASYNC;
  const auto self = static_cast<std::uint32_t>(::getpid());
  switch (call) {
#if defined(__x86_64__)
    case __NR_open:
      return without_bits(1, kWrites);
#endif
    case __NR_openat:
      return without_bits(2, kWrites);
    case __NR_clone:
      return threads_alone(answer_to_start(program));
    case __NR_prlimit64:
      return own_limits();
    case __NR_fcntl:  // but not F_SETOWN, F_SETSIG and F_SETFL, by which the kernel signals another process
      return one_of(1, {F_GETFD, F_SETFD, F_GETFL, F_DUPFD, F_DUPFD_CLOEXEC});
    case __NR_ioctl:  // whether a stream is a terminal
      return one_of(1, {TCGETS, TIOCGWINSZ, FIOCLEX, FIONCLEX});
    case __NR_prctl:
      return one_of(0, {PR_SET_NAME, PR_GET_NAME});
    default:  // kill() and tgkill(), for abort()
      return one_of(0, {self});
  }
}

Filter system_call_filter(HelperProgram program) {
  Filter filter;
  load(filter, offsetof(seccomp_data, arch));
  filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, kArchitecture, 1, 0));
  answer(filter, kRefuse);
  load(filter, offsetof(seccomp_data, nr));
#if defined(__x86_64__)
  answer_if(filter, BPF_JGE, 0x40000000u, kRefuse);  // the x32 interface has numbers of its own
#endif
  for (const int call : calls_of(program)) answer_if(filter, BPF_JEQ, static_cast<std::uint32_t>(call), kAllow);
  for (const int call : kByArguments) {
    const Filter test = test_of_arguments(call, program);
    filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(call), 0,
                              static_cast<std::uint8_t>(test.size())));
    filter.insert(filter.end(), test.begin(), test.end());
  }
  for (const int call : kStarting) {
    answer_if(filter, BPF_JEQ, static_cast<std::uint32_t>(call), answer_to_start(program));
  }
  answer_if(filter, BPF_JGE, kFirstRecent, kAbsent);
  answer(filter, kRefuse);
  return filter;
}

#endif

}  // namespace

std::vector<int> allowed_system_calls(HelperProgram program) {
  std::vector<int> calls = calls_of(program);
  append(calls, {listed(kByArguments)});
  return calls;
}

bool restrict_system_calls([[maybe_unused]] HelperProgram program) {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 || kArchitecture == 0) return false;
  Filter filter = system_call_filter(program);
  const sock_fprog code{static_cast<unsigned short>(filter.size()), filter.data()};
  return ::syscall(__NR_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_TSYNC, &code) == 0;
#else
  return false;
#endif
}

}  // namespace simvis
