#include "exchange/packets/capture_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "engine/base/file_writing.h"
#include "engine/base/output_target.h"
#include "engine/base/temporary_file.h"

namespace simvis {

CaptureFile::CaptureFile(std::filesystem::path path, std::string_view beginning,
                         const std::function<void()>& before_name)
    : path_(std::move(path)) {
  const OutputTarget target = output_target(path_);
  if (target.is_stream) {
    file_ = open_device(target.file, path_);
    begin(beginning);
    return;
  }
  target_ = target.file;
  TemporaryFile file(target_, path_, O_APPEND);
  write_all(file.descriptor(), path_, beginning);
  size_ = beginning.size();
  if (before_name) before_name();
  file.put_in_place();
  file_ = file.release();
}

CaptureFile::~CaptureFile() {
  if (file_ >= 0) ::close(file_);
}

// The destructor of an object whose constructor throws is not called.
void CaptureFile::begin(std::string_view beginning) {
  try {
    append(beginning);
  } catch (...) {
    ::close(file_);
    throw;
  }
}

void CaptureFile::append(std::string_view records) {
  if (!is_stream()) require_own_name(target_, file_);
  try {
    write_all(file_, path_, records);
  } catch (...) {
    if (!is_stream() && ::ftruncate(file_, static_cast<off_t>(size_)) != 0) errno = 0;  // the first error counts
    throw;
  }
  size_ += records.size();
}

void CaptureFile::close() {
  if (!is_stream()) require_own_name(target_, file_);
  if (::close(std::exchange(file_, -1)) != 0) throw_file_error(path_, "cannot be closed", errno);
}

}  // namespace simvis
