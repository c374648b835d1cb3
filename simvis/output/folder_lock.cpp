#include "simvis/output/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>

#include <simvis/error.h>
#include "simvis/output/atomic_file.h"

namespace simvis {

FolderLock::FolderLock(const std::filesystem::path& folder, bool shared)
    : descriptor_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (descriptor_ < 0) throw_file_error(folder, "cannot be opened", errno);
  if (::flock(descriptor_, (shared ? LOCK_SH : LOCK_EX) | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  ::close(descriptor_);
  throw InputError(folder.string() + ": error: another run is writing to this folder, expected another --out");
}

FolderLock::~FolderLock() { ::close(descriptor_); }

}  // namespace simvis
