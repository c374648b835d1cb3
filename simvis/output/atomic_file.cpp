#include "simvis/output/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <string_view>
#include <system_error>

#include <simvis/error.h>
#include "engine/base/assert.h"
#include "engine/base/hidden_file.h"
#include "engine/base/output_target.h"

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

AtomicFile::AtomicFile(std::filesystem::path path) : path_(std::move(path)) {
  const OutputTarget target = output_target(path_);
  target_ = target.file;
  if (target.is_stream) {
    // Some devices wait in open() until the other side answers.
    descriptor_ = ::open(target_.c_str(), O_WRONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (descriptor_ < 0) throw_file_error(path_, "cannot be opened", errno);
    ::fcntl(descriptor_, F_SETFL, ::fcntl(descriptor_, F_GETFL) & ~O_NONBLOCK);
    return;
  }
  temporary_ = hidden_name(target_);
  descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) throw_file_error(path_, "cannot be created", errno);
  struct stat replaced {};
  if (::stat(target_.c_str(), &replaced) == 0) ::fchmod(descriptor_, replaced.st_mode & 0777);  // it keeps its mode
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void AtomicFile::write(std::string_view bytes) {
  SIMVIS_ASSERT(descriptor_ >= 0);
  write_all(descriptor_, path_, bytes);
}

void AtomicFile::rewrite(std::uint64_t offset, std::string_view bytes) {
  SIMVIS_ASSERT(descriptor_ >= 0 && !temporary_.empty());
  if (::lseek(descriptor_, static_cast<off_t>(offset), SEEK_SET) < 0)
    throw_file_error(path_, "cannot be written", errno);
  write_all(descriptor_, path_, bytes);
  if (::lseek(descriptor_, 0, SEEK_END) < 0) throw_file_error(path_, "cannot be written", errno);
}

void AtomicFile::commit() {
  SIMVIS_ASSERT(descriptor_ >= 0);
  // Some file systems report a full disk only at close().
  const int closed = ::close(descriptor_);
  descriptor_ = -1;
  if (closed != 0) throw_file_error(path_, "cannot be written", errno);
  if (temporary_.empty()) return;
  if (std::rename(temporary_.c_str(), target_.c_str()) != 0)
    throw_file_error(path_, "cannot be renamed into place", errno);
  temporary_.clear();
}

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw MachineError(folder.string() + ": error: the folder cannot be created: " + error.message());
}

void write_file(const std::filesystem::path& path, std::string_view bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

}  // namespace simvis
