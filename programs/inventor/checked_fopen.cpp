#include "programs/inventor/checked_fopen.h"

#include <dlfcn.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <exception>
#include <string_view>

#include <simvis/error.h>
#include "engine/base/input_file.h"
#include "engine/base/read_error.h"

namespace simvis {
namespace {

// Of files that include each other. The system gives the lowest number that is free, so it counts the open files. The
// limit on open files (process_limits.cpp) is higher.
constexpr int kMaxOpen = 128;

std::exception_ptr read_fault;

std::FILE* file_in_memory(const char* name, std::span<const std::uint8_t> bytes) {
  const int memory = ::memfd_create("part", MFD_CLOEXEC);
  if (memory < 0) throw_read_error(name, "cannot be held in memory", errno);
  if (memory >= kMaxOpen) {
    ::close(memory);
    errno = ELOOP;
    return nullptr;
  }
  while (!bytes.empty()) {
    const ssize_t written = ::write(memory, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw MachineError(std::string(name) + ": error: there is no memory to hold the file");
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  ::lseek(memory, 0, SEEK_SET);
  return ::fdopen(memory, "rb");
}

std::FILE* system_fopen(const char* name, const char* mode) {
  using Open = std::FILE* (*)(const char*, const char*);
  static const auto open = reinterpret_cast<Open>(::dlsym(RTLD_NEXT, "fopen"));
  return open(name, mode);
}

std::FILE* checked_fopen(const char* name, const char* mode) try {
  const bool reads = std::string_view(mode).starts_with('r') && std::string_view(mode).find('+') == std::string::npos;
  if (!reads || !is_input_file(name)) return system_fopen(name, mode);
  const Bytes bytes = read_whole_file(name);
  if (bytes.empty()) return system_fopen(name, mode);  // also the files of /proc, whose size is not known
  return file_in_memory(name, bytes);
} catch (const InputError&) {
  errno = EACCES;
  return nullptr;
} catch (...) {
  if (!read_fault) read_fault = std::current_exception();
  errno = EIO;
  return nullptr;
}

}  // namespace

void rethrow_read_fault() {
  if (read_fault) std::rethrow_exception(read_fault);
}

}  // namespace simvis

extern "C" __attribute__((visibility("default"))) std::FILE* fopen(const char* name, const char* mode) {
  return simvis::checked_fopen(name, mode);
}
