// A file that appears complete or not at all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

#include "engine/base/temporary_file.h"

namespace simvis {

/// The file is written as a TemporaryFile in the same folder and renamed by commit(). If the object is destroyed
/// without commit(), as after an exception, the temporary file is removed and an existing file at `path` is unchanged.
/// A ResultLock keeps a second run from the file.
///
/// output_target() decides what may be replaced; a character device, such as /dev/null, is written to at once.
///
/// Errors   MachineError with the path and the reason from the operating system, such as a folder that is not writable
///          or a full disk; InputError of output_target().
/// Special  safe against the end of the program, but not against a power failure: commit() does not wait for the disk.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::string_view bytes);
  /// Writes over bytes that have been written. The file is none of the devices.
  void rewrite(std::uint64_t offset, std::string_view bytes);
  /// Closes the file and gives it its final name. Do not call write() afterwards.
  void commit();

  const std::filesystem::path& path() const { return path_; }

 private:
  int descriptor() const { return file_ ? file_->descriptor() : device_; }

  std::filesystem::path path_;
  std::optional<TemporaryFile> file_;  // empty: the target is a device, or commit() has ended
  int device_ = -1;
};

/// Creates a folder and its parent folders if they do not exist. Throws MachineError as AtomicFile does.
void make_folder(const std::filesystem::path& folder);

/// Writes a small file in one call, through AtomicFile.
void write_file(const std::filesystem::path& path, std::string_view bytes);

}  // namespace simvis
