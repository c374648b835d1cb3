#include "simvis/output/growing_file.h"

#include <fcntl.h>
#include <stdio.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "engine/base/hidden_file.h"
#include "engine/base/output_target.h"
#include "simvis/output/atomic_file.h"

namespace simvis {

namespace {

// The smallest page of the machines that SimVis runs on.
constexpr std::uintmax_t kPageBytes = 4096;

int open_for_append(const std::filesystem::path& file, const std::filesystem::path& named, int more) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC | more, 0666);
  if (descriptor < 0) throw_file_error(named, "cannot be opened", errno);
  return descriptor;
}

}  // namespace

GrowingFile::GrowingFile(const std::filesystem::path& path, std::string_view start)
    : path_(regular_target(path)), twin_path_(hidden_name(path_)), size_(start.size()), missing_(start) {
  write_file(path_, start);
  file_ = open_for_append(path_, path_, 0);
}

GrowingFile::GrowingFile(const std::filesystem::path& path, std::uintmax_t size)
    : path_(regular_target(path)), twin_path_(hidden_name(path_)), size_(size) {
  std::error_code error;
  std::filesystem::resize_file(path_, size, error);
  if (error) throw_file_error(path_, "cannot be cut", error.value());
  file_ = open_for_append(path_, path_, 0);
}

GrowingFile::~GrowingFile() {
  if (file_ >= 0) ::close(file_);
  if (twin_ < 0) return;
  ::close(twin_);
  ::unlink(twin_path_.c_str());
}

void GrowingFile::append(std::string_view bytes) {
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
  if (::close(std::exchange(file_, -1)) != 0) throw_file_error(path_, "cannot be written", errno);
}

// A file that is continued is copied; the beginning of a new one is in missing_.
void GrowingFile::make_twin() {
  if (size_ > missing_.size()) {
    std::error_code error;
    std::filesystem::copy_file(path_, twin_path_, std::filesystem::copy_options::overwrite_existing, error);
    if (error) throw_file_error(path_, "cannot be copied", error.value());
    missing_.clear();
  }
  twin_ = open_for_append(twin_path_, path_, O_CREAT);
}

bool GrowingFile::exchange_with_twin() {
  if (::renameat2(AT_FDCWD, twin_path_.c_str(), AT_FDCWD, path_.c_str(), RENAME_EXCHANGE) == 0) return true;
  if (errno != EINVAL && errno != ENOSYS) throw_file_error(path_, "cannot be put in place", errno);
  return false;
}

}  // namespace simvis
