// A file that is read part by part.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace simvis {

using Bytes = std::vector<std::uint8_t>;

/// A regular file, held open: another one that takes its name meanwhile does not mix with it.
class InputFile {
 public:
  /// Throws InputError naming the file and the operating system's reason.
  explicit InputFile(const std::filesystem::path& file);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  std::size_t size() const { return size_; }  ///< bytes, when it was opened

  /// All `count` bytes from `first` on. Throws InputError where they are not there any more.
  Bytes read(std::size_t first, std::size_t count) const;

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
  std::size_t size_ = 0;
};

/// Throws InputError like InputFile.
Bytes read_whole_file(const std::filesystem::path& file);

}  // namespace simvis
