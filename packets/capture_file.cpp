#include "packets/capture_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <string>
#include <system_error>
#include <utility>

#include <simvis/error.h>
#include "engine/base/hidden_file.h"
#include "engine/base/output_target.h"

namespace simvis {
namespace {

[[noreturn]] void fail_on_growth(const std::filesystem::path& file, const char* what, int error) {
  throw MachineError(file.string() + ": error: " + what + ": " + std::generic_category().message(error));
}

}  // namespace

CaptureFile::CaptureFile(std::filesystem::path path, std::string_view beginning,
                         const std::function<void()>& before_name)
    : path_(std::move(path)) {
  const OutputTarget target = output_target(path_);
  is_stream_ = target.is_stream;
  if (!is_stream_) remove_leftovers_of(target.file);
  const std::filesystem::path hidden = is_stream_ ? target.file : hidden_name(target.file);
  const int flags = O_WRONLY | O_CLOEXEC | (is_stream_ ? 0 : O_CREAT | O_TRUNC | O_APPEND);
  file_ = ::open(hidden.c_str(), flags, 0666);
  if (file_ < 0) fail_on_growth(path_, "cannot be opened", errno);
  try {
    append(beginning);
    if (!is_stream_ && before_name) before_name();
    if (!is_stream_ && std::rename(hidden.c_str(), target.file.c_str()) != 0) {
      fail_on_growth(path_, "cannot be put in place", errno);
    }
  } catch (...) {
    ::close(file_);
    if (!is_stream_) ::unlink(hidden.c_str());
    throw;
  }
}

CaptureFile::~CaptureFile() {
  if (file_ >= 0) ::close(file_);
}

void CaptureFile::append(std::string_view records) {
  try {
    write(records);
  } catch (...) {
    if (!is_stream_ && ::ftruncate(file_, static_cast<off_t>(size_)) != 0) errno = 0;  // the first error counts
    throw;
  }
  size_ += records.size();
}

void CaptureFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail_on_growth(path_, "cannot be written", errno);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void CaptureFile::close() {
  if (::close(std::exchange(file_, -1)) != 0) fail_on_growth(path_, "cannot be closed", errno);
}

}  // namespace simvis
