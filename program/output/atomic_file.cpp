#include "program/output/atomic_file.h"

#include <unistd.h>

#include <cerrno>
#include <string_view>
#include <system_error>
#include <utility>

#include <simvis/error.h>
#include "engine/base/assert.h"
#include "engine/base/file_writing.h"
#include "engine/base/output_target.h"

namespace simvis {

AtomicFile::AtomicFile(std::filesystem::path path) : path_(std::move(path)) {
  const OutputTarget target = output_target(path_);
  if (target.is_stream) {
    device_ = open_device(target.file, path_);
  } else {
    file_.emplace(target.file, path_);
  }
}

AtomicFile::~AtomicFile() {
  if (device_ >= 0) ::close(device_);
}

void AtomicFile::write(std::string_view bytes) {
  SIMVIS_ASSERT(descriptor() >= 0);
  write_all(descriptor(), path_, bytes);
}

void AtomicFile::rewrite(std::uint64_t offset, std::string_view bytes) {
  SIMVIS_ASSERT(file_);
  if (::lseek(descriptor(), static_cast<off_t>(offset), SEEK_SET) < 0)
    throw_file_error(path_, "cannot be written", errno);
  write_all(descriptor(), path_, bytes);
  if (::lseek(descriptor(), 0, SEEK_END) < 0) throw_file_error(path_, "cannot be written", errno);
}

void AtomicFile::commit() {
  SIMVIS_ASSERT(descriptor() >= 0);
  if (!file_) {
    if (::close(std::exchange(device_, -1)) != 0) throw_file_error(path_, "cannot be written", errno);
    return;
  }
  file_->close();
  file_->put_in_place();
  file_.reset();
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
