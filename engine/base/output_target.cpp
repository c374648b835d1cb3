#include "engine/base/output_target.h"

#include <sys/stat.h>

#include <string>
#include <system_error>

#include <simvis/error.h>

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

/// The end of a chain of links to a file that does not exist.
fs::path follow_links(const fs::path& named) {
  fs::path file = named;
  for (int links = 0; links <= kMaxLinks; ++links) {
    std::error_code error;
    const fs::path next = fs::read_symlink(file, error);
    if (error) return file;
    file = file.parent_path() / next;
  }
  throw InputError(named.string() + " is a chain of more than " + std::to_string(kMaxLinks) +
                   " symbolic links, expected a regular file");
}

}  // namespace

OutputTarget output_target(const fs::path& named) {
  struct stat status {};
  // An unreadable folder is reported when the file is created.
  if (::stat(named.c_str(), &status) != 0) return {follow_links(named)};
  if (S_ISCHR(status.st_mode)) return {named, true};
  if (!S_ISREG(status.st_mode)) refuse_target(named, status.st_mode, "a regular file or a character device");
  return {fs::is_symlink(named) ? fs::canonical(named) : named};
}

fs::path regular_target(const fs::path& named) {
  struct stat status {};
  if (::stat(named.c_str(), &status) == 0 && !S_ISREG(status.st_mode)) {
    refuse_target(named, status.st_mode, "a regular file");
  }
  return output_target(named).file;
}

}  // namespace simvis
