#include "programs/system_calls.h"

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
#include <cstdint>
#include <vector>

namespace simvis {
namespace {

#if defined(__x86_64__)
[[maybe_unused]] constexpr std::uint32_t kArchitecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
[[maybe_unused]] constexpr std::uint32_t kArchitecture = AUDIT_ARCH_AARCH64;
#else
[[maybe_unused]] constexpr std::uint32_t kArchitecture = 0;  // no filter
#endif

constexpr int kFchmodat2 = 452;  // headers of Linux before 6.6 do not name it

[[maybe_unused]] constexpr int kRefused[] = {
#if defined(__x86_64__)
    __NR_fork, __NR_vfork, __NR_creat, __NR_unlink, __NR_rename, __NR_mkdir, __NR_rmdir, __NR_link, __NR_symlink,
    __NR_mknod, __NR_chmod, __NR_chown, __NR_lchown, __NR_utime, __NR_utimes, __NR_futimesat, __NR_iopl, __NR_ioperm,
#endif
    // files
    __NR_unlinkat, __NR_renameat, __NR_renameat2, __NR_mkdirat, __NR_linkat, __NR_symlinkat, __NR_mknodat, __NR_fchmod,
    __NR_fchmodat, kFchmodat2, __NR_fchown, __NR_fchownat, __NR_truncate, __NR_utimensat, __NR_setxattr, __NR_lsetxattr,
    __NR_fsetxattr, __NR_removexattr, __NR_lremovexattr, __NR_fremovexattr, __NR_open_by_handle_at,
    __NR_name_to_handle_at,
    // network and other processes
    __NR_socket, __NR_socketpair, __NR_connect, __NR_bind, __NR_execve, __NR_execveat, __NR_ptrace,
    __NR_process_vm_readv, __NR_process_vm_writev, __NR_tkill, __NR_rt_sigqueueinfo, __NR_rt_tgsigqueueinfo,
    __NR_pidfd_open, __NR_pidfd_send_signal, __NR_pidfd_getfd, __NR_kcmp, __NR_shmget, __NR_shmat, __NR_msgget,
    __NR_semget, __NR_mq_open, __NR_setpriority, __NR_setpgid, __NR_setsid, __NR_sched_setscheduler,
    __NR_sched_setparam, __NR_sched_setattr, __NR_ioprio_set,
    // rights and the kernel
    __NR_mount, __NR_umount2, __NR_pivot_root, __NR_chroot, __NR_unshare, __NR_setns, __NR_setuid, __NR_setgid,
    __NR_setreuid, __NR_setregid, __NR_setresuid, __NR_setresgid, __NR_setgroups, __NR_capset, __NR_personality,
    __NR_bpf, __NR_io_uring_setup, __NR_io_uring_enter, __NR_io_uring_register, __NR_userfaultfd, __NR_perf_event_open,
    __NR_keyctl, __NR_add_key, __NR_request_key, __NR_init_module, __NR_finit_module, __NR_delete_module,
    __NR_kexec_load, __NR_reboot, __NR_swapon, __NR_swapoff, __NR_sethostname, __NR_setdomainname, __NR_settimeofday,
    __NR_clock_settime, __NR_adjtimex, __NR_quotactl, __NR_acct, __NR_syslog, __NR_vhangup, __NR_fanotify_init};

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

// Asked first, because a large part makes them a hundred thousand times.
constexpr int kFrequent[] = {__NR_pread64, __NR_read, __NR_write, __NR_brk, __NR_mmap, __NR_munmap};

constexpr std::uint32_t kAllow = SECCOMP_RET_ALLOW, kRefuse = SECCOMP_RET_ERRNO | EPERM;
// The C library then takes an older call, whose arguments the filter can see.
constexpr std::uint32_t kAbsent = SECCOMP_RET_ERRNO | ENOSYS;

using Filter = std::vector<sock_filter>;

void load(Filter& filter, std::size_t offset) {
  filter.push_back(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offset)));
}

// The low half of an argument; the processors are little-endian.
constexpr std::size_t argument(std::size_t number) {
  return offsetof(seccomp_data, args) + number * sizeof(std::uint64_t);
}

void answer(Filter& filter, std::uint32_t result) { filter.push_back(BPF_STMT(BPF_RET | BPF_K, result)); }

// For the call with this number.
void answer_call(Filter& filter, int call, std::uint32_t result) {
  filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(call), 0, 1));
  answer(filter, result);
}

// For the call with this number: `if_true` where the test of one of its arguments holds, otherwise `if_false`.
void test_argument(Filter& filter, int call, std::size_t number, std::uint16_t test, std::uint32_t value,
                   std::uint32_t if_true, std::uint32_t if_false) {
  filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(call), 0, 4));
  load(filter, argument(number));
  filter.push_back(BPF_JUMP(static_cast<std::uint16_t>(BPF_JMP | test | BPF_K), value, 0, 1));
  answer(filter, if_true);
  answer(filter, if_false);
}

Filter system_call_filter() {
  constexpr std::uint32_t kWrites = O_WRONLY | O_RDWR | O_CREAT | O_TRUNC;
  Filter filter;
  load(filter, offsetof(seccomp_data, arch));
  filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, kArchitecture, 1, 0));
  answer(filter, kRefuse);
  load(filter, offsetof(seccomp_data, nr));
#if defined(__x86_64__)
  // The calls of the x32 interface have numbers of their own.
  filter.push_back(BPF_JUMP(BPF_JMP | BPF_JGE | BPF_K, 0x40000000u, 0, 1));
  answer(filter, kRefuse);
#endif
  for (const int call : kFrequent) answer_call(filter, call, kAllow);
#if defined(__x86_64__)
  test_argument(filter, __NR_open, 1, BPF_JSET, kWrites, kRefuse, kAllow);
#endif
  test_argument(filter, __NR_openat, 2, BPF_JSET, kWrites, kRefuse, kAllow);
  test_argument(filter, __NR_clone, 0, BPF_JSET, CLONE_THREAD, kAllow, kRefuse);
  const auto self = static_cast<std::uint32_t>(::getpid());
  test_argument(filter, __NR_kill, 0, BPF_JEQ, self, kAllow, kRefuse);
  test_argument(filter, __NR_tgkill, 0, BPF_JEQ, self, kAllow, kRefuse);  // abort()
  test_argument(filter, __NR_prlimit64, 0, BPF_JEQ, 0, kAllow, kRefuse);  // 0: the own process
  answer_call(filter, __NR_clone3, kAbsent);
  answer_call(filter, __NR_openat2, kAbsent);
  for (const int call : kRefused) answer_call(filter, call, kRefuse);
  answer(filter, kAllow);
  return filter;
}

#endif

}  // namespace

void restrict_system_calls() {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 || kArchitecture == 0) return;
  Filter filter = system_call_filter();
  const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
  ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program);
#endif
}

}  // namespace simvis
