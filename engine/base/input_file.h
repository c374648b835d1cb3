// A file that is read in parts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <utility>
#include <vector>

#include "engine/base/program_api.h"

namespace simvis {

using Bytes = std::vector<std::uint8_t>;

/// A regular file that stays open. If another file takes its name in the meantime, the reads still use the first file.
/// This is how all files are opened that a part or a request names: the file that is open is the one that was checked.
///
/// Errors   InputError naming the file: it is not there, may not be read (read_fence.h), is no regular file.
/// MachineError naming it:
///          the disk fails, too many files are open. Both with the operating system's reason; see read_error.h.
class InputFile {
 public:
  explicit InputFile(const std::filesystem::path& file);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  std::size_t size() const { return size_; }  ///< bytes at the time of opening

  /// Returns exactly `count` bytes from `first` on. Throws InputError if the file no longer has them.
  Bytes read(std::size_t first, std::size_t count) const;

  /// Fills `bytes` from `first` on, or their beginning if the file ends before. Returns how many there are.
  std::size_t read_into(std::span<std::uint8_t> bytes, std::size_t first) const;

 private:
  struct NotOpened {};
  InputFile(std::filesystem::path file, NotOpened) : file_(std::move(file)) {}

  std::filesystem::path file_;
  int descriptor_ = -1;
  std::size_t size_ = 0;
};

/// Reads all bytes of the file. Throws like InputFile.
SIMVIS_PROGRAM_API Bytes read_whole_file(const std::filesystem::path& file);

}  // namespace simvis
