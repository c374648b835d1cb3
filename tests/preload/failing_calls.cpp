// A library for LD_PRELOAD that makes one call about a file fail, as on a disk that fails:
//   SIMVIS_FAIL_IN=PROGRAM     only in programs of this name
//   SIMVIS_FAIL_FILE=FILE      this file; or
//   SIMVIS_FAIL_BELOW=FOLDER   all files below this folder
//   SIMVIS_FAIL_CALL=read      reads: read(), pread(), fread(). Or open: open() and fopen(); write: write() and
//                              pwrite(); rename, ftruncate, mmap; close, of files that are open for writing and no
//                              locks. Or memory: before a pread(), an allocation fails, and nothing else happens
//   SIMVIS_FAIL_AT=K           the call with this number, counted from 1 in each process; 0: none
//   SIMVIS_FAIL_ERRNO=NUMBER   its error. 0, for reads and writes: the call is short, it moves half of the bytes
//   SIMVIS_FAIL_MARK=FILE      gets a byte when a call fails
//   SIMVIS_FAIL_COUNT=FILE     gets a byte for each call that could fail
// The files are opened before the program begins, because a helper program may write no file.
#include <dlfcn.h>
#include <fcntl.h>
#include <limits.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdint>
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
int opened(const char* name) {
  const char* const file = std::getenv(name);
  if (file == nullptr || !is_in_program()) return -1;
  return static_cast<int>(::syscall(SYS_openat, AT_FDCWD, file, O_CREAT | O_WRONLY | O_APPEND | O_CLOEXEC, 0600));
}

const int mark = opened("SIMVIS_FAIL_MARK"), count = opened("SIMVIS_FAIL_COUNT");

void add_byte(int file) {
  if (file >= 0 && ::syscall(SYS_write, file, "!", 1) != 1) std::abort();
}

bool is_chosen(std::string_view file) {
  const std::string_view folder = variable("SIMVIS_FAIL_BELOW");
  if (!folder.empty()) return file.size() > folder.size() && file.starts_with(folder) && file[folder.size()] == '/';
  return !file.empty() && file == variable("SIMVIS_FAIL_FILE");
}

bool fails(std::string_view call, std::string_view file) {
  static std::atomic<int> calls{0};
  if (call != variable("SIMVIS_FAIL_CALL") || !is_chosen(file) || !is_in_program()) return false;
  // The file of a lock is empty: its close loses nothing.
  if (call == "close" && file.find(".simvis-lock") != file.npos) return false;
  add_byte(count);
  if (++calls != std::atoi(variable("SIMVIS_FAIL_AT").data())) return false;
  add_byte(mark);
  errno = std::atoi(variable("SIMVIS_FAIL_ERRNO").data());
  return true;
}

bool fails(std::string_view call, int descriptor) {
  char link[64], file[PATH_MAX];
  const int error = errno;
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const ssize_t size = ::readlink(link, file, sizeof file);
  errno = error;
  return size > 0 && fails(call, std::string_view(file, static_cast<std::size_t>(size)));
}

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

// What a call about `bytes` bytes does: all of them, half of them, or none for an error.
template <class Call>
ssize_t tried(std::string_view name, int descriptor, size_t bytes, Call call) {
  if (!fails(name, descriptor)) return call(bytes);
  return errno == 0 ? call((bytes + 1) / 2) : -1;
}

mode_t mode_of(int flags, va_list rest) { return (flags & O_CREAT) != 0 ? va_arg(rest, mode_t) : 0; }

}  // namespace

extern "C" {
ssize_t read(int descriptor, void* bytes, size_t count) {
  return tried("read", descriptor, count,
               [&](size_t most) { return next<decltype(::read)>("read")(descriptor, bytes, most); });
}

ssize_t pread(int descriptor, void* bytes, size_t count, off_t from) {
  constexpr size_t kMoreThanThereIs = size_t{1} << 46;
  // Volatile, because a compiler may leave out an allocation without a use.
  if (fails("memory", descriptor)) [[maybe_unused]]
    void* volatile unused = std::malloc(kMoreThanThereIs);
  return tried("read", descriptor, count,
               [&](size_t most) { return next<decltype(::pread)>("pread")(descriptor, bytes, most, from); });
}

// What _FORTIFY_SOURCE makes of the two.
ssize_t __read_chk(int descriptor, void* bytes, size_t count, size_t room) {
  if (count > room) std::abort();
  return read(descriptor, bytes, count);
}
ssize_t __pread_chk(int descriptor, void* bytes, size_t count, off_t from, size_t room) {
  if (count > room) std::abort();
  return pread(descriptor, bytes, count, from);
}

size_t fread(void* bytes, size_t size, size_t count, FILE* file) {
  return fails("read", ::fileno(file)) ? 0 : next<decltype(::fread)>("fread")(bytes, size, count, file);
}

ssize_t write(int descriptor, const void* bytes, size_t count) {
  return tried("write", descriptor, count,
               [&](size_t most) { return next<decltype(::write)>("write")(descriptor, bytes, most); });
}

ssize_t pwrite(int descriptor, const void* bytes, size_t count, off_t to) {
  return tried("write", descriptor, count,
               [&](size_t most) { return next<decltype(::pwrite)>("pwrite")(descriptor, bytes, most, to); });
}

// Of the C++ library's streams.
ssize_t writev(int descriptor, const struct iovec* parts, int count) {
  return fails("write", descriptor) ? -1
                                    : next<ssize_t(int, const struct iovec*, int)>("writev")(descriptor, parts, count);
}

int open(const char* file, int flags, ...) {
  if (fails("open", file)) return -1;
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = mode_of(flags, rest);
  va_end(rest);
  return next<int(const char*, int, ...)>("open")(file, flags, mode);
}

int open64(const char* file, int flags, ...) {
  if (fails("open", file)) return -1;
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = mode_of(flags, rest);
  va_end(rest);
  return next<int(const char*, int, ...)>("open64")(file, flags, mode);
}

FILE* fopen(const char* file, const char* mode) {
  return fails("open", file) ? nullptr : next<decltype(::fopen)>("fopen")(file, mode);
}

FILE* fopen64(const char* file, const char* mode) {
  return fails("open", file) ? nullptr : next<decltype(::fopen64)>("fopen64")(file, mode);
}

int rename(const char* from, const char* to) {
  return fails("rename", to) ? -1 : next<decltype(::rename)>("rename")(from, to);
}

int ftruncate(int descriptor, off_t size) {
  return fails("ftruncate", descriptor) ? -1 : next<decltype(::ftruncate)>("ftruncate")(descriptor, size);
}

// A close() that fails closes the file, as that of Linux does. That of a file or folder that is only read loses
// nothing.
int close(int descriptor) {
  const int error_before = errno, flags = ::fcntl(descriptor, F_GETFL);
  errno = error_before;
  const bool is_read = flags >= 0 && (flags & O_ACCMODE) == O_RDONLY;
  const bool is_failure = !is_read && fails("close", descriptor);
  const int error = errno, result = next<decltype(::close)>("close")(descriptor);
  if (!is_failure) return result;
  errno = error;
  return -1;
}

void* mmap(void* at, size_t size, int protection, int flags, int descriptor, off_t from) {
  return descriptor >= 0 && fails("mmap", descriptor)
             ? MAP_FAILED
             : next<decltype(::mmap)>("mmap")(at, size, protection, flags, descriptor, from);
}
}
