// A file that grows by whole pieces: whenever its reader or a kill comes, it ends where a piece ends.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "engine/base/temporary_file.h"

namespace simvis {

/// append() makes all its bytes visible at once. A write within one page of the file is not interrupted. Longer pieces
/// go to a hidden twin, which then exchanges its name with the file; the twin catches up at the next exchange. On file
/// systems that cannot exchange names, all pieces are written to the file itself.
///
/// Errors   MachineError with the path and the reason from the operating system. The file then ends as after the last
///          append(). MachineError too if the name leads to another file, or to none, since what is written would be
///          lost. InputError of regular_target().
/// Special  safe against the end of the program, but not against a power failure.
class GrowingFile {
 public:
  /// Creates the file with this beginning, or replaces it.
  GrowingFile(const std::filesystem::path& path, std::string_view start);
  /// Continues an existing file behind its first `size` bytes; the rest is cut off.
  GrowingFile(const std::filesystem::path& path, std::uintmax_t size);
  /// Removes the twin. The file stays.
  ~GrowingFile();
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;

  void append(std::string_view bytes);
  /// Closes the file: some file systems report a full disk only then. Nothing follows it.
  void finish();

 private:
  void append_or_cut(std::string_view bytes);
  bool exchange_with_twin();
  void make_twin();

  std::filesystem::path path_;
  std::optional<TemporaryFile> twin_file_;  // holds the hidden name
  int file_ = -1, twin_ = -1;
  std::uintmax_t size_ = 0;
  std::string missing_;  // what the file has and the twin has not
  bool exchanges_ = true;
};

}  // namespace simvis
