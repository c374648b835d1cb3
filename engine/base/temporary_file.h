// New files that get their name when they are complete, and what killed programs leave of them.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "engine/base/program_api.h"

namespace simvis {

/// A new, empty file in the folder of its target, open for writing under a hidden name that cannot be guessed. What
/// another user has put under this name, a symbolic link among it, is never opened. The file has the permissions of
/// the file that it replaces. All temporary files of SimVis are made here.
///
/// Errors   MachineError with the path and the reason from the operating system.
class SIMVIS_PROGRAM_API TemporaryFile {
 public:
  /// `target` is that of output_target(). Messages name `named`, which leads to it. `flags`: of open(), such as
  /// O_APPEND.
  TemporaryFile(std::filesystem::path target, std::filesystem::path named, int flags = 0);
  /// Closes the file, and removes it if it is not in place.
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  int descriptor() const { return descriptor_; }
  const std::filesystem::path& hidden_name() const { return hidden_; }

  /// Closes the file: some file systems report a full disk only then.
  void close();
  /// Gives the file the name of the target.
  void put_in_place();
  /// Returns the descriptor, which the caller closes.
  int release();

 private:
  std::filesystem::path target_, named_, hidden_;
  int descriptor_ = -1;
};

/// Writes a whole file through TemporaryFile. `target` and `named` as there.
SIMVIS_PROGRAM_API void replace_file(const std::filesystem::path& target, const std::filesystem::path& named,
                                     std::string_view bytes);

/// ".NAME" and `end`. Of a long name only the beginning is kept, because file systems limit names to 255 bytes.
std::string hidden_file_name(std::string_view name, std::string_view end);

/// Removes files with names of TemporaryFile from the folder, but not from folders in it. Those of processes of this
/// machine that run stay: they may be of files that another run writes there. If `own_only`, those of other machines
/// stay too. Errors are ignored.
SIMVIS_PROGRAM_API void remove_leftovers(const std::filesystem::path& folder, bool own_only);

/// Removes the temporary files of this file alone that processes of this machine left, which have ended. Reads the
/// whole folder: for files that a user names, not for each picture of a run. Errors are ignored.
SIMVIS_PROGRAM_API void remove_leftovers_of(const std::filesystem::path& path);

}  // namespace simvis
