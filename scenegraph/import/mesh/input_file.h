// A file that is read in parts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace simvis {

using Bytes = std::vector<std::uint8_t>;

/// A regular file that stays open. If another file takes its name in the meantime, the reads still use the first file.
class InputFile {
 public:
  /// Throws InputError naming the file and the operating system's reason.
  explicit InputFile(const std::filesystem::path& file);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  std::size_t size() const { return size_; }  ///< bytes at the time of opening

  /// Returns exactly `count` bytes from `first` on. Throws InputError if the file no longer has them.
  Bytes read(std::size_t first, std::size_t count) const;

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
  std::size_t size_ = 0;
};

/// Reads all bytes of the file. Throws InputError like InputFile.
Bytes read_whole_file(const std::filesystem::path& file);

}  // namespace simvis
