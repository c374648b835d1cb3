#include "engine/base/output_target.h"

#include <fcntl.h>
#include <limits.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>

#include <simvis/error.h>
#include "engine/base/file_writing.h"

namespace simvis {

namespace {

namespace fs = std::filesystem;

// As many as Linux follows.
constexpr int kMaxLinks = 40;

const char* kind_of(mode_t mode) {
  switch (mode & S_IFMT) {
    case S_IFDIR:
      return "a folder";
    case S_IFBLK:
      return "a block device";
    case S_IFCHR:
      return "a character device";
    case S_IFIFO:
      return "a FIFO or a pipe";
    case S_IFSOCK:
      return "a socket";
    default:
      return "no regular file";
  }
}

[[noreturn]] void refuse_target(const fs::path& named, mode_t mode, const char* expected) {
  throw InputError(named.string() + " is " + kind_of(mode) + ", expected " + expected);
}

/// A file or a link itself, neither read nor followed; nothing if there is none.
class LinkHandle {
 public:
  /// Throws MachineError about `named`, also for a folder that cannot be searched.
  LinkHandle(const fs::path& file, const fs::path& named)
      : descriptor_(::open(file.c_str(), O_PATH | O_NOFOLLOW | O_CLOEXEC)) {
    if (descriptor_ < 0 && errno != ENOENT && errno != ENOTDIR) throw_file_error(named, "cannot be created", errno);
  }
  ~LinkHandle() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  LinkHandle(const LinkHandle&) = delete;
  LinkHandle& operator=(const LinkHandle&) = delete;

  bool is_link(struct stat& status) const {
    return descriptor_ >= 0 && ::fstat(descriptor_, &status) == 0 && S_ISLNK(status.st_mode);
  }
  fs::path leads_to() const {
    char text[PATH_MAX];
    const ssize_t bytes = ::readlinkat(descriptor_, "", text, sizeof text);
    return bytes < 0 ? fs::path() : fs::path(std::string(text, static_cast<std::size_t>(bytes)));
  }

 private:
  int descriptor_;
};

/// Throws if another user may have put the link there. As the kernel's protected_symlinks: in a folder where all users
/// may write, only links of this user and of the folder's owner are followed.
void require_own_link(const fs::path& named, const fs::path& file, const struct stat& link) {
  const fs::path parent = file.parent_path();
  struct stat folder {};
  if (::stat(parent.empty() ? "." : parent.c_str(), &folder) != 0) return;
  const bool is_shared = (folder.st_mode & S_ISVTX) != 0 && (folder.st_mode & S_IWOTH) != 0;
  if (!is_shared || link.st_uid == ::geteuid() || link.st_uid == folder.st_uid) return;
  throw InputError(named.string() + " is a symbolic link of another user in a folder where all users may write, " +
                   "expected a regular file");
}

/// What a chain of links leads to. Each link is read once, so that it cannot be exchanged after the check.
fs::path follow_links(const fs::path& named) {
  fs::path file = named;
  for (int links = 0; links <= kMaxLinks; ++links) {
    const LinkHandle handle(file, named);
    struct stat status {};
    if (!handle.is_link(status)) return file;
    require_own_link(named, file, status);
    file = file.parent_path() / handle.leads_to();
  }
  throw InputError(named.string() + " is a chain of more than " + std::to_string(kMaxLinks) +
                   " symbolic links, expected a regular file");
}

}  // namespace

OutputTarget output_target(const fs::path& named) {
  const fs::path file = follow_links(named);
  struct stat status {};
  if (::stat(named.c_str(), &status) != 0) return {file};
  if (S_ISCHR(status.st_mode)) return {named, true};
  if (!S_ISREG(status.st_mode)) refuse_target(named, status.st_mode, "a regular file or a character device");
  return {file};
}

fs::path regular_target(const fs::path& named) {
  struct stat status {};
  if (::stat(named.c_str(), &status) == 0 && !S_ISREG(status.st_mode)) {
    refuse_target(named, status.st_mode, "a regular file");
  }
  return output_target(named).file;
}

}  // namespace simvis
