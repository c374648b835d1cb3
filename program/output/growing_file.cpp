#include "program/output/growing_file.h"

#include <fcntl.h>
#include <stdio.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include <simvis/error.h>
#include "engine/base/file_writing.h"
#include "engine/base/output_target.h"

namespace simvis {

namespace {

// The smallest page of the machines that SimVis runs on.
constexpr std::uintmax_t kPageBytes = 4096;

int open_beginning(const std::filesystem::path& file, int flags) {
  const int descriptor = ::open(file.c_str(), flags | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor < 0) throw_file_error(file, "cannot be opened", errno);
  return descriptor;
}

/// Copies the first `size` bytes of the file.
void copy_beginning(const std::filesystem::path& from, std::uintmax_t size, int to) {
  struct Source {
    int descriptor;
    ~Source() { ::close(descriptor); }
  };
  const Source source{open_beginning(from, O_RDONLY)};
  std::string bytes(std::size_t{1} << 16, '\0');
  for (std::uintmax_t done = 0; done < size;) {
    const std::size_t count = std::min<std::uintmax_t>(size - done, bytes.size());
    const ssize_t got = ::pread(source.descriptor, bytes.data(), count, static_cast<off_t>(done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) throw_file_error(from, "cannot be copied", got < 0 ? errno : EIO);
    write_all(to, from, std::string_view(bytes).substr(0, static_cast<std::size_t>(got)));
    done += static_cast<std::uintmax_t>(got);
  }
}

}  // namespace

GrowingFile::GrowingFile(const std::filesystem::path& path, std::string_view start)
    : path_(regular_target(path)), size_(start.size()), missing_(start) {
  TemporaryFile file(path_, path_, O_APPEND);
  write_all(file.descriptor(), path_, start);
  file.put_in_place();
  file_ = file.release();
}

GrowingFile::GrowingFile(const std::filesystem::path& path, std::uintmax_t size) : path_(path), size_(size) {
  // The run that began the file has written a regular one.
  if (std::filesystem::is_symlink(path_)) {
    throw InputError(path_.string() + ": error: is a symbolic link, expected the file that the run has begun");
  }
  file_ = open_beginning(path_, O_WRONLY | O_APPEND);
  if (::ftruncate(file_, static_cast<off_t>(size)) == 0) return;
  const int error = errno;
  ::close(file_);
  throw_file_error(path_, "cannot be cut", error);
}

GrowingFile::~GrowingFile() {
  if (file_ >= 0) ::close(file_);
  if (twin_ >= 0) ::close(twin_);
}

void GrowingFile::append(std::string_view bytes) {
  require_own_name(path_, file_);
  const bool in_one_page = size_ % kPageBytes + bytes.size() <= kPageBytes;
  if (in_one_page || !exchanges_) {
    append_or_cut(bytes);
    if (exchanges_) missing_ += bytes;
    size_ += bytes.size();
    return;
  }
  if (twin_ < 0) make_twin();
  missing_ += bytes;
  write_all(twin_, path_, missing_);
  if (exchange_with_twin()) {
    std::swap(file_, twin_);
  } else {
    exchanges_ = false;
    append_or_cut(bytes);
  }
  size_ += bytes.size();
  missing_ = bytes;
}

// The file ends as before if not all bytes can be written.
void GrowingFile::append_or_cut(std::string_view bytes) {
  try {
    write_all(file_, path_, bytes);
  } catch (...) {
    (void)!::ftruncate(file_, static_cast<off_t>(size_));
    throw;
  }
}

void GrowingFile::finish() {
  if (file_ < 0) return;
  require_own_name(path_, file_);
  if (::close(std::exchange(file_, -1)) != 0) throw_file_error(path_, "cannot be written", errno);
}

// A file that is continued is copied; the beginning of a new one is in missing_.
void GrowingFile::make_twin() {
  twin_file_.emplace(path_, path_, O_APPEND);
  if (size_ > missing_.size()) {
    copy_beginning(path_, size_, twin_file_->descriptor());
    missing_.clear();
  }
  twin_ = twin_file_->release();
}

bool GrowingFile::exchange_with_twin() {
  const char* const twin = twin_file_->hidden_name().c_str();
  if (::renameat2(AT_FDCWD, twin, AT_FDCWD, path_.c_str(), RENAME_EXCHANGE) == 0) return true;
  if (errno != EINVAL && errno != ENOSYS) throw_file_error(path_, "cannot be put in place", errno);
  return false;
}

}  // namespace simvis
