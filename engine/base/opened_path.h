// What a path leads to, held open.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

namespace simvis {

/// What a path leads to. If another file takes the name, this one stays. Opened for looks alone: its bytes are not
/// read, and a FIFO or a device is not opened.
class OpenedPath {
 public:
  explicit OpenedPath(const std::filesystem::path& path)
      : descriptor_(::open(path.c_str(), O_PATH | O_CLOEXEC)), error_(descriptor_ < 0 ? errno : 0) {}
  ~OpenedPath() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  OpenedPath(const OpenedPath&) = delete;
  OpenedPath& operator=(const OpenedPath&) = delete;

  int descriptor() const { return descriptor_; }
  int error() const { return error_; }  ///< number of the operating system's error; 0: it is open

 private:
  int descriptor_;
  int error_;
};

}  // namespace simvis
