#include "engine/base/result_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <utility>

#include <simvis/error.h>
#include "engine/base/file_writing.h"
#include "engine/base/fnv1a.h"
#include "engine/base/folder_entries.h"
#include "engine/base/output_target.h"
#include "engine/base/temporary_file.h"

namespace simvis {

namespace {

constexpr std::string_view kLockEnding = ".simvis-lock";

// A process that removes an unheld lock file, or finds that it was removed, holds its lock for an instant.
constexpr int kLockTries = 10;
constexpr useconds_t kLockPause_us = 2000;

/// False: another process holds a lock. File systems without locks are not guarded.
bool try_lock(int descriptor, int kind) {
  int result = 0;
  do result = ::flock(descriptor, kind | LOCK_NB);
  while (result != 0 && errno == EINTR);
  return result == 0 || errno != EWOULDBLOCK;
}

/// The process of this machine that holds a lock on the open file, as the kernel lists it.
std::optional<long> lock_holder(int descriptor) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) return std::nullopt;
  char file[64];
  std::snprintf(file, sizeof file, "%02x:%02x:%llu", major(status.st_dev), minor(status.st_dev),
                static_cast<unsigned long long>(status.st_ino));
  std::ifstream locks("/proc/locks");
  for (std::string line; std::getline(locks, line);) {
    std::istringstream words(line);
    std::string number, kind, mode, access, locked;
    long process = 0;
    words >> number >> kind >> mode >> access >> process >> locked;
    if (kind == "FLOCK" && locked == file && process > 0) return process;
  }
  return std::nullopt;
}

[[noreturn]] void refuse_second_run(const std::filesystem::path& named, int descriptor, const char* what) {
  const std::optional<long> holder = lock_holder(descriptor);
  const std::string who = !holder                 ? "another run"
                          : *holder == ::getpid() ? "this process"
                                                  : "another run (process " + std::to_string(*holder) + ")";
  throw MachineError(named.string() + ": error: " + who + " is writing to this " + what);
}

/// Names that are cut differ by a hash of the whole name.
std::filesystem::path lock_file_of(const std::filesystem::path& target) {
  const std::string name = target.filename().string();
  std::filesystem::path file = target.parent_path() / hidden_file_name(name, kLockEnding);
  if (file.filename().string().size() == 1 + name.size() + kLockEnding.size()) return file;
  return target.parent_path() / hidden_file_name(name, "." + std::to_string(fnv1a(name)) + std::string(kLockEnding));
}

int open_lock_file(const std::filesystem::path& lock, const std::filesystem::path& named) {
  // NFS locks only files that are open for writing. Nothing is written, and no link is followed.
  constexpr int kFlags = O_NOFOLLOW | O_NOCTTY | O_NONBLOCK | O_CLOEXEC;
  int descriptor = ::open(lock.c_str(), O_RDWR | O_CREAT | kFlags, 0666);
  const int error = errno;
  // Another user's, or in a folder of all users: it can be locked without the right to write it.
  if (descriptor < 0 && error == EACCES) descriptor = ::open(lock.c_str(), O_RDONLY | kFlags);
  if (descriptor < 0) throw_file_error(named, "cannot be created", error);
  return descriptor;
}

}  // namespace

HeldLock::~HeldLock() {
  if (descriptor < 0) return;
  if (!file.empty() && leads_to(file, descriptor)) ::unlink(file.c_str());
  ::close(descriptor);
}

FolderLock::FolderLock(const std::filesystem::path& folder, bool shared) {
  held_.descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (held_.descriptor < 0) throw_file_error(folder, "cannot be opened", errno);
  if (!try_lock(held_.descriptor, shared ? LOCK_SH : LOCK_EX)) refuse_second_run(folder, held_.descriptor, "folder");
}

ResultLock::ResultLock(const std::filesystem::path& named) {
  const OutputTarget target = output_target(named);
  if (target.is_stream) return;
  std::filesystem::path file = lock_file_of(target.file);
  for (int tries = 1;; ++tries) {
    held_.descriptor = open_lock_file(file, named);
    const bool is_free = try_lock(held_.descriptor, LOCK_EX);
    // The process that held the lock may have removed its file in the meantime.
    if (is_free && leads_to(file, held_.descriptor)) break;
    if (tries == kLockTries) refuse_second_run(named, held_.descriptor, "file");
    ::close(std::exchange(held_.descriptor, -1));
    ::usleep(kLockPause_us);
  }
  held_.file = std::move(file);
  remove_leftovers_of(target.file);
}

void remove_unheld_locks(const std::filesystem::path& folder) {
  try {
    for (const std::filesystem::path& file : folder_entries(folder)) {
      if (!file.filename().string().ends_with(kLockEnding)) continue;
      const int descriptor = ::open(file.c_str(), O_RDWR | O_NOFOLLOW | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
      if (descriptor < 0) continue;
      if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0 && leads_to(file, descriptor)) ::unlink(file.c_str());
      ::close(descriptor);
    }
  } catch (const Error&) {  // the folder cannot be listed
  }
}

}  // namespace simvis
