// Keeps two runs from writing the same results at the same time.
#pragma once

#include <filesystem>

#include "engine/base/program_api.h"

namespace simvis {

/// An open file or folder with a lock, which ends with this object. It is a member of those below, so that it also ends
/// where their constructors throw.
struct SIMVIS_PROGRAM_API HeldLock {
  int descriptor = -1;
  std::filesystem::path file;  ///< is removed if it still leads to the descriptor; empty: none is

  HeldLock() = default;
  ~HeldLock();
  HeldLock(const HeldLock&) = delete;
  HeldLock& operator=(const HeldLock&) = delete;
};

/// A lock on a folder itself, so that no file of it stays. The operating system releases it when the process ends,
/// however it ends. File systems that cannot lock folders are not guarded; NFS guards them on one machine alone.
class SIMVIS_PROGRAM_API FolderLock {
 public:
  /// `shared`: processes that share may write at the same time, but not beside one that does not.
  /// Throws MachineError naming the folder if another process holds a lock that this one does not allow, or if the
  /// folder cannot be opened.
  FolderLock(const std::filesystem::path& folder, bool shared);

 private:
  HeldLock held_;
};

/// A lock on one named file: from before its first byte to its end. It is a lock on a hidden empty file beside it,
/// ".NAME.simvis-lock", which goes with this object. A killed process leaves this file without the lock; the next run
/// takes it over. The temporary files that killed runs left of the named file are removed.
///
/// Special  a character device is not locked. On file systems without locks, results are not guarded.
class SIMVIS_PROGRAM_API ResultLock {
 public:
  /// Throws InputError of output_target(); MachineError naming the file if another run is writing it, also one of this
  /// process, and if its folder cannot be written.
  explicit ResultLock(const std::filesystem::path& named);

 private:
  HeldLock held_;
};

/// Removes the files of locks that killed processes left in the folder. Errors are ignored.
SIMVIS_PROGRAM_API void remove_unheld_locks(const std::filesystem::path& folder);

}  // namespace simvis
