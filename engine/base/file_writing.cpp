#include "engine/base/file_writing.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>

#include <simvis/error.h>

namespace simvis {

void throw_file_error(const std::filesystem::path& path, const char* what, int error) {
  throw MachineError(path.string() + ": error: " + what + ": " + std::generic_category().message(error));
}

void write_all(int descriptor, const std::filesystem::path& path, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw_file_error(path, "cannot be written", errno);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

int open_device(const std::filesystem::path& device, const std::filesystem::path& named) {
  // Some devices wait in open() until the other side answers, and so does a FIFO.
  const int descriptor = ::open(device.c_str(), O_WRONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) throw_file_error(named, "cannot be opened", errno);
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || !S_ISCHR(status.st_mode)) {
    ::close(descriptor);
    throw MachineError(named.string() + ": error: was a character device and is something else now");
  }
  ::fcntl(descriptor, F_SETFL, ::fcntl(descriptor, F_GETFL) & ~O_NONBLOCK);
  return descriptor;
}

bool leads_to(const std::filesystem::path& name, int descriptor) {
  struct stat named {
  }, open{};
  return ::lstat(name.c_str(), &named) == 0 && ::fstat(descriptor, &open) == 0 && named.st_dev == open.st_dev &&
         named.st_ino == open.st_ino;
}

void require_own_name(const std::filesystem::path& name, int descriptor) {
  if (leads_to(name, descriptor)) return;
  throw MachineError(name.string() + ": error: was removed, renamed or replaced while it was written");
}

}  // namespace simvis
