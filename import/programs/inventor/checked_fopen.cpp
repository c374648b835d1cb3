#include "import/programs/inventor/checked_fopen.h"

#include <dlfcn.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>
#include <vector>

#include <simvis/error.h>
#include "engine/base/input_file.h"
#include "engine/base/read_error.h"
#include "engine/base/read_fence.h"
#include "import/programs/inventor/vrml_files.h"

namespace simvis {
namespace {

// Of files that include each other. The system gives the lowest number that is free, so it counts the open files. The
// limit on open files (process_limits.cpp) is higher.
constexpr int kMaxOpen = 128;

std::exception_ptr read_fault;
VrmlFiles* vrml_files = nullptr;

// A file that Coin has opened, and the file in memory that it reads.
struct OpenFile {
  int descriptor = -1;
  ino_t number = 0;
  std::filesystem::path file;
};
std::vector<OpenFile> open_files;

std::optional<ino_t> number_of(int descriptor) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) return std::nullopt;
  return status.st_ino;
}

// Returns whether the file is open already. Descriptors of files that Coin has closed may be those of other files.
bool is_within_itself(const std::filesystem::path& file) {
  std::erase_if(open_files, [](const OpenFile& each) { return number_of(each.descriptor) != each.number; });
  std::vector<std::filesystem::path> chain;
  for (const OpenFile& each : open_files) {
    if (each.file == file || !chain.empty()) chain.push_back(each.file);
  }
  if (chain.empty()) return false;
  vrml_files->refuse_circle(chain);
  return true;
}

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
  if (!reads) return system_fopen(name, mode);
  const bool is_fenced = read_scope().has_value();
  if (!is_input_file(name)) {
    if (!is_fenced) return system_fopen(name, mode);
    errno = ENOENT;
    return nullptr;
  }
  const Bytes bytes = read_whole_file(name);
  if (bytes.empty() && !is_fenced) return system_fopen(name, mode);  // a file of /proc, whose size is not known
  if (vrml_files == nullptr) return file_in_memory(name, bytes);
  std::error_code error;
  std::filesystem::path file = std::filesystem::canonical(name, error);
  if (error) file = name;
  if (is_within_itself(file)) {
    errno = ELOOP;
    return nullptr;
  }
  const auto text = vrml_files->text_of(name, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  if (vrml_files->has_fault()) {  // Coin might crash on the text
    errno = EACCES;
    return nullptr;
  }
  std::FILE* const opened =
      text ? file_in_memory(name, {reinterpret_cast<const std::uint8_t*>(text->data()), text->size()})
           : file_in_memory(name, bytes);
  if (opened == nullptr) return nullptr;
  const int descriptor = ::fileno(opened);
  open_files.push_back({descriptor, number_of(descriptor).value_or(0), file});
  return opened;
} catch (const InputError&) {
  errno = EACCES;
  return nullptr;
} catch (...) {
  if (!read_fault) read_fault = std::current_exception();
  errno = EIO;
  return nullptr;
}

}  // namespace

void open_files_by(VrmlFiles& files) { vrml_files = &files; }

void rethrow_read_fault() {
  if (read_fault) std::rethrow_exception(read_fault);
}

}  // namespace simvis

extern "C" __attribute__((visibility("default"))) std::FILE* fopen(const char* name, const char* mode) {
  return simvis::checked_fopen(name, mode);
}
