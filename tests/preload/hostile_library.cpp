// A library for LD_PRELOAD that does in simvis-import-mesh what an attacker would do whose file has made a library run
// his code: at the first read of the part it tries what a program that reads must not do. For each attempt that the
// system allows it writes a word to SIMVIS_HOSTILE_LOG, and "tried" at the end.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>

namespace {

constexpr long kFchmodat2 = 452;

bool is_helper() { return std::strcmp(program_invocation_short_name, "simvis-import-mesh") == 0; }

// Opened before the program begins.
const int report = is_helper() ? ::open(std::getenv("SIMVIS_HOSTILE_LOG"), O_CREAT | O_WRONLY | O_APPEND, 0600) : -1;

void say(const char* word) {
  if (::write(report, word, std::strlen(word)) < 0) std::abort();
}

void try_all() {
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
  if (::syscall(SYS_io_uring_setup, 1, nullptr) >= 0 || errno != EPERM) say("io_uring ");
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  if (child > 0) say("fork ");
  char* const arguments[] = {const_cast<char*>("true"), nullptr};
  say("tried");
  ::execv("/bin/true", arguments);
}

}  // namespace

extern "C" ssize_t pread(int descriptor, void* bytes, size_t count, off_t from) {
  static bool has_tried = false;
  if (is_helper() && !has_tried) {
    has_tried = true;
    try_all();
  }
  return reinterpret_cast<decltype(::pread)*>(::dlsym(RTLD_NEXT, "pread"))(descriptor, bytes, count, from);
}
