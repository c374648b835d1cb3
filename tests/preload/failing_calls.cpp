// A library for LD_PRELOAD that makes one call about a file fail, as on a disk that fails:
//   SIMVIS_FAIL_IN=PROGRAM     only in programs of this name
//   SIMVIS_FAIL_FILE=FILE      this file
//   SIMVIS_FAIL_CALL=read      reads: read(), pread(), fread(). Or open: open() and fopen(). Or memory: before a
//                              pread(), an allocation fails, and nothing else happens
//   SIMVIS_FAIL_AT=K           the call with this number, counted from 1 in each process
//   SIMVIS_FAIL_ERRNO=NUMBER   its error
//   SIMVIS_FAIL_MARK=FILE      gets a byte when a call fails
// The file is opened before the program begins, because a helper program may write no file.
#include <dlfcn.h>
#include <fcntl.h>
#include <limits.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace {

std::string_view variable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

bool is_in_program() { return variable("SIMVIS_FAIL_IN") == program_invocation_short_name; }

// By a direct system call, which is not counted.
const int mark = is_in_program() ? static_cast<int>(::syscall(SYS_openat, AT_FDCWD, std::getenv("SIMVIS_FAIL_MARK"),
                                                              O_CREAT | O_WRONLY | O_APPEND, 0600))
                                 : -1;

bool fails(std::string_view call, std::string_view file) {
  static std::atomic<int> calls{0};
  if (file.empty() || file != variable("SIMVIS_FAIL_FILE") || call != variable("SIMVIS_FAIL_CALL")) return false;
  if (!is_in_program()) return false;
  if (++calls != std::atoi(variable("SIMVIS_FAIL_AT").data())) return false;
  if (::write(mark, "!", 1) != 1) std::abort();
  errno = std::atoi(variable("SIMVIS_FAIL_ERRNO").data());
  return true;
}

bool fails(std::string_view call, int descriptor) {
  char link[64], file[PATH_MAX];
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const ssize_t size = ::readlink(link, file, sizeof file);
  return size > 0 && fails(call, std::string_view(file, static_cast<std::size_t>(size)));
}

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {
ssize_t read(int descriptor, void* bytes, size_t count) {
  return fails("read", descriptor) ? -1 : next<decltype(::read)>("read")(descriptor, bytes, count);
}

ssize_t pread(int descriptor, void* bytes, size_t count, off_t from) {
  constexpr size_t kMoreThanThereIs = size_t{1} << 46;
  // Volatile, because a compiler may leave out an allocation without a use.
  if (fails("memory", descriptor)) [[maybe_unused]]
    void* volatile unused = std::malloc(kMoreThanThereIs);
  return fails("read", descriptor) ? -1 : next<decltype(::pread)>("pread")(descriptor, bytes, count, from);
}

size_t fread(void* bytes, size_t size, size_t count, FILE* file) {
  return fails("read", ::fileno(file)) ? 0 : next<decltype(::fread)>("fread")(bytes, size, count, file);
}

int open(const char* file, int flags, ...) {
  if (fails("open", file)) return -1;
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  return next<int(const char*, int, ...)>("open")(file, flags, mode);
}

FILE* fopen(const char* file, const char* mode) {
  return fails("open", file) ? nullptr : next<decltype(::fopen)>("fopen")(file, mode);
}

FILE* fopen64(const char* file, const char* mode) {
  return fails("open", file) ? nullptr : next<decltype(::fopen64)>("fopen64")(file, mode);
}
}
